// Compares the exact decision about minimum distances with bisection of time, which uses no polynomials: an interval is
// free if the features are beyond the minimum distance along one direction at both of its ends. As points move on
// straight lines, they then are in between.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "exact/integer.h"
#include "impacts/min_distance_moves.h"

namespace crumple {
namespace {

using Point = Vec3<Integer>;

struct Fraction {
    Integer over = 0, under = 1;

    friend bool operator<(const Fraction& x, const Fraction& y) { return x.over * y.under < y.over * x.under; }
    friend bool operator==(const Fraction& x, const Fraction& y) { return !(x < y) && !(y < x); }
};

/// Returns the square of x, which must be a multiple of 2^-200.
Fraction squared(double x) {
    const Integer integer = in_units(x, -200);
    return {integer * integer, Integer(1) << 400};
}

/// Two features at one time, in integers: the first `first` points belong to the first feature.
struct Sample {
    std::vector<Point> points;
    std::size_t first;
    Integer denominator;  ///< coordinates are those of `points` divided by this

    /// Calls look(direction), until it returns true, for all directions in which the closest points of two sets may lie
    /// from one another: between two vertices, from a vertex across to a line, and normal to a plane.
    void for_directions(const auto& look) const {
        const auto both = [&](const Point& direction) { return look(direction) || look(Point{} - direction); };
        const std::size_t n = points.size();
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j) {
                const Point side = points[j] - points[i];
                if (both(side)) return;
                for (std::size_t k = 0; k < n; ++k) {
                    const Point across = points[k] - points[i];
                    if (both(dot(side, side) * across - dot(side, across) * side)) return;
                }
            }
        }
        if (n < 4) return;
        const Point u = points[1] - points[0], v = points[3] - points[2], w = points[3] - points[1];
        static_cast<void>(both(cross(u, v)) || both(cross(v, w)));
    }

    /// Returns the square of how far the second feature lies beyond the first along `direction`, or 0 if it does not.
    Fraction gap(const Point& direction) const {
        std::optional<Integer> high, low;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Integer height = dot(direction, points[i]);
            if (i < first && (!high || height > *high)) high = height;
            if (i >= first && (!low || height < *low)) low = height;
        }
        const Integer between = *low - *high;
        if (between <= 0) return {};
        return {between * between, denominator * denominator * dot(direction, direction)};
    }

    /// Returns the squared distance of the features: the widest gap.
    Fraction distance() const {
        Fraction widest;
        for_directions([&](const Point& direction) {
            widest = std::max(widest, gap(direction));
            return false;
        });
        return widest;
    }
};

class Bisection {
   public:
    explicit Bisection(const MinDistanceMove& query) : first_(query.move.feature == Feature::edge_edge ? 2 : 1) {
        for (std::size_t i = 0; i < points_of(query.move.feature); ++i) {
            start_.push_back(in_units(query.move.point[i].start, 0));
            step_.push_back(in_units(query.move.point[i].end, 0) - start_.back());
        }
        const Fraction share = squared(query.separation.share), begin = at(0, 1).distance();
        limit_ = std::max(squared(query.separation.distance), {share.over * begin.over, share.under * begin.under});
    }

    static constexpr int depth = 20;
    static constexpr std::int64_t end = std::int64_t{1} << depth;

    /// Returns the first k for which no direction keeps the features beyond the distance from k / 2^depth to (k + 1) /
    /// 2^depth.
    std::optional<std::int64_t> first_not_free(std::int64_t from = 0, std::int64_t to = end) const {
        if (free(from, to)) return std::nullopt;
        if (to - from == 1) return from;
        const std::int64_t middle = (from + to) / 2;
        const auto found = first_not_free(from, middle);
        return found ? found : first_not_free(middle, to);
    }

    /// Returns the features at time k / q.
    Sample at(std::int64_t k, std::int64_t q) const {
        Sample sample{{}, first_, q};
        for (std::size_t i = 0; i < start_.size(); ++i)
            sample.points.push_back(Integer(q) * start_[i] + Integer(k) * step_[i]);
        return sample;
    }

    /// Returns the square of the minimum distance.
    const Fraction& limit() const { return limit_; }

   private:
    bool free(std::int64_t from, std::int64_t to) const {
        const Sample begin = at(from, end), finish = at(to, end);
        bool found = false;
        at(from + to, 2 * end).for_directions([&](const Point& direction) {
            found = limit_ < begin.gap(direction) && limit_ < finish.gap(direction);
            return found;
        });
        return found;
    }

    std::size_t first_;  ///< number of points of the first feature
    std::vector<Point> start_, step_;
    Fraction limit_;
};

/// Returns k / q rounded down.
double rounded_down(int k, int q) {
    const double quotient = static_cast<double>(k) / q;
    return std::fma(quotient, q, -k) > 0 ? std::nextafter(quotient, 0.0) : quotient;
}

class MinDistanceBisection : public testing::TestWithParam<Feature> {};

TEST_P(MinDistanceBisection, impacts_match_bisection_within_a_64th_of_the_time) {
    // Shortly before a closest approach, no direction keeps the features beyond the distance throughout an interval of
    // length 2^-20. This begins up to 2^-6 before the impact.
    constexpr double grazing = 0x1p-6;
    int hits = 0, later = 0, all = 0;
    for (const Lattice lattice : all_lattices) {
        RandomMoves random(lattice, 41);
        for (int i = 0; i < 40; ++i, ++all) {
            const MinDistanceMove query = separated(random, lattice, GetParam());
            const Impact impact = query.impact();
            const auto found = Bisection(query).first_not_free();
            ASSERT_EQ(impact.meets, found.has_value()) << query;
            if (!found) continue;
            ++hits;
            later += impact.toi > 0;
            const double time = std::ldexp(static_cast<double>(*found), -Bisection::depth);
            ASSERT_GE(impact.toi, time) << query;
            ASSERT_LE(impact.toi, time + grazing) << query;
        }
    }
    EXPECT_GT(later, all / 10);
    EXPECT_LT(hits, all);
}

TEST_P(MinDistanceBisection, impacts_are_consistent_with_exact_distances_at_simple_fractions_of_time) {
    // Computes the exact distance at times k / q with small q. If it is within the minimum distance, the impact is not
    // later. If the time of impact is k / q rounded down, the distance at k / q equals the minimum distance.
    constexpr int largest = 6;
    int exact = 0;
    for (const Lattice lattice : {Lattice::tiny, Lattice::flat, Lattice::line}) {
        RandomMoves random(lattice, 43);
        for (int i = 0; i < 150; ++i) {
            const MinDistanceMove query = separated(random, lattice, GetParam());
            const Impact impact = query.impact();
            const Bisection bisection(query);
            for (int q = 1; q <= largest; ++q) {
                for (int k = 0; k <= q; ++k) {
                    const Fraction distance = bisection.at(k, q).distance();
                    const double time = rounded_down(k, q);
                    if (!(bisection.limit() < distance)) {
                        ASSERT_TRUE(impact.meets) << k << " / " << q << ": " << query;
                        ASSERT_LE(impact.toi, time) << k << " / " << q << ": " << query;
                        ASSERT_TRUE(k > 0 || impact.start) << query;
                    } else {
                        ASSERT_TRUE(k > 0 || !impact.start) << query;
                    }
                    if (!impact.meets || k == 0 || impact.toi != time) continue;
                    ASSERT_EQ(distance, bisection.limit()) << k << " / " << q << ": " << query;
                    ++exact;
                }
            }
        }
    }
    EXPECT_GT(exact, 10);
}

TEST_P(MinDistanceBisection, approaching_only_reports_when_features_get_nearer_than_at_start) {
    constexpr int largest = 8;
    int hits = 0, later = 0, all = 0;
    for (const Lattice lattice : all_lattices) {
        RandomMoves random(lattice, 59);
        for (int i = 0; i < 60; ++i, ++all) {
            MinDistanceMove query{random(GetParam()), {.distance = 1e6, .approaching_only = true}};
            const Bisection bisection(query);
            const Fraction begin = bisection.at(0, 1).distance();
            const Impact impact = query.impact();
            hits += impact.meets;
            later += impact.meets && !impact.start;
            for (int q = 1; q <= largest; ++q) {
                for (int k = 1; k <= q; ++k) {
                    if (!(bisection.at(k, q).distance() < begin)) continue;
                    ASSERT_TRUE(impact.meets) << k << " / " << q << ": " << query;
                    ASSERT_LE(impact.toi, rounded_down(k, q)) << query;
                }
            }
            const bool at_once = bisection.at(1, Bisection::end).distance() < begin;
            ASSERT_TRUE(!at_once || (impact.meets && impact.toi <= std::ldexp(1., -Bisection::depth))) << query;
            if (!impact.meets) continue;
            const auto soon = static_cast<std::int64_t>(std::ldexp(impact.toi, Bisection::depth)) + 1;
            ASSERT_LT(bisection.at(soon, Bisection::end).distance(), begin) << query;
        }
    }
    EXPECT_GT(hits, all / 10);
    EXPECT_LT(hits, all);
    if (GetParam() != Feature::vertex_vertex) {
        EXPECT_GT(later, 0);
    }
}

std::string name_of(const testing::TestParamInfo<Feature>& info) {
    constexpr const char* names[] = {"VertexFace", "EdgeEdge", "VertexEdge", "VertexVertex"};
    return names[static_cast<int>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Features, MinDistanceBisection, testing::ValuesIn(all_features), name_of);

}  // namespace
}  // namespace crumple
