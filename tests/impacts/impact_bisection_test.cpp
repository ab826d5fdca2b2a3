// Compares the exact decision of impacts with bisection of time, which uses no polynomials: an interval is free if one
// direction separates the two features at both of its ends. As points move on straight lines, that direction then
// separates them in between.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "exact/intersection/exact_intersection.h"
#include "impacts/random_moves.h"

namespace crumple {
namespace {

using Point = Vec3<Integer>;

/// Bisection of the time of a move in integer arithmetic. Positions at time k / 2^depth are in units of 2^-depth.
class Bisection {
   public:
    explicit Bisection(const Move& move) : first_(move.feature == Feature::edge_edge ? 2 : 1) {
        for (std::size_t i = 0; i < points_of(move.feature); ++i) {
            start_.push_back(in_units(move.point[i].start, 0));
            step_.push_back(in_units(move.point[i].end, 0) - start_.back());
        }
    }

    static constexpr int depth = 20;
    static constexpr std::int64_t end = std::int64_t{1} << depth;

    /// Returns the first k for which no direction separates the features from k / 2^depth to (k + 1) / 2^depth.
    std::optional<std::int64_t> first_not_free(std::int64_t from = 0, std::int64_t to = end) const {
        if (free(from, to)) return std::nullopt;
        if (to - from == 1) return from;
        const std::int64_t middle = (from + to) / 2;
        const auto found = first_not_free(from, middle);
        return found ? found : first_not_free(middle, to);
    }

   private:
    using Points = std::vector<Point>;

    Points at(std::int64_t k) const {
        Points points;
        points.reserve(start_.size());
        for (std::size_t i = 0; i < start_.size(); ++i)
            points.push_back(Integer(end) * start_[i] + Integer(k) * step_[i]);
        return points;
    }

    /// Calls look(direction), until it returns true, for all directions in which the closest points of two disjoint
    /// sets may lie from one another: between two vertices, from a vertex across to a line, and normal to a plane.
    static void for_directions(const Points& points, const auto& look) {
        const std::size_t n = points.size();
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j) {
                const Point side = points[j] - points[i];
                if (look(side)) return;
                for (std::size_t k = 0; k < n; ++k) {
                    const Point across = points[k] - points[i];
                    if (look(dot(side, side) * across - dot(side, across) * side)) return;
                }
            }
        }
        if (n < 4) return;
        for (std::size_t i = 1; i < n; ++i) {
            const Point u = points[i] - points[0], v = points[i % 3 + 1] - points[0];
            if (look(cross(u, v)) || look(cross(u, points[i % 3 + 1] - points[(i + 1) % 3 + 1]))) return;
        }
        look(cross(points[2] - points[1], points[3] - points[1]));
    }

    /// True if all of the first feature lies strictly before all of the second along `direction`.
    bool separates(const Point& direction, const Points& points) const {
        std::optional<Integer> low[2], high[2];
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t side = i < first_ ? 0 : 1;
            const Integer height = dot(direction, points[i]);
            if (!low[side] || height < *low[side]) low[side] = height;
            if (!high[side] || height > *high[side]) high[side] = height;
        }
        return *high[0] < *low[1];
    }

    bool free(std::int64_t from, std::int64_t to) const {
        // In units of half the size, positions in the middle of the interval are integers, too.
        const Points begin = at(from), finish = at(to);
        Points middle = begin;
        for (std::size_t i = 0; i < middle.size(); ++i) middle[i] = begin[i] + finish[i];
        bool found = false;
        for_directions(middle, [&](const Point& direction) {
            const Point opposite = Point{} - direction;
            found = (separates(direction, begin) && separates(direction, finish)) ||
                    (separates(opposite, begin) && separates(opposite, finish));
            return found;
        });
        return found;
    }

    std::size_t first_;  ///< number of points of the first feature
    Points start_, step_;
};

/// True if the features touch at time k / q, by the exact intersection of triangles.
bool touch_at(const Move& move, int k, int q) {
    const auto position = [&](std::size_t i) {
        const MovingPoint& p = move.point[i];
        return static_cast<double>(q) * p.start + static_cast<double>(k) * (p.end - p.start);
    };
    const std::size_t n = points_of(move.feature), first = move.feature == Feature::edge_edge ? 2 : 1;
    const Triangle a{{position(0), position(first - 1), position(0)}, {0, 1, 2}};
    const Triangle b{{position(first), position(n > 2 ? first + 1 : first), position(n - 1)}, {3, 4, 5}};
    return intersect_rationally(a, b).collides;
}

/// Returns k / q rounded down.
double rounded_down(int k, int q) {
    const double quotient = static_cast<double>(k) / q;
    return std::fma(quotient, q, -k) > 0 ? std::nextafter(quotient, 0.0) : quotient;
}

class ImpactBisection : public testing::TestWithParam<Feature> {};

TEST_P(ImpactBisection, impacts_match_bisection_within_a_64th_of_the_time) {
    // Shortly before a grazing contact, no direction separates the features throughout an interval of length h = 2^-20.
    // This begins up to about the cube root of h before the contact.
    constexpr double grazing = 0x1p-6;
    int hits = 0;
    for (const Lattice lattice : all_lattices) {
        RandomMoves random(lattice, 31);
        for (int i = 0; i < 60; ++i) {
            const Move move = random(GetParam());
            const Impact impact = move.impact();
            const auto found = Bisection(move).first_not_free();
            ASSERT_EQ(impact.meets, found.has_value()) << move;
            if (!found) continue;
            ++hits;
            const double time = std::ldexp(static_cast<double>(*found), -Bisection::depth);
            ASSERT_GE(impact.toi, time) << move;
            ASSERT_LE(impact.toi, time + grazing) << move;
        }
    }
    EXPECT_GT(hits, 10);
}

TEST_P(ImpactBisection, impacts_are_consistent_with_exact_contact_at_simple_fractions_of_time) {
    // Tests exactly whether the features touch at times k / q with small q. If they do, the impact is not later. If the
    // time of impact is k / q rounded down, they touch at k / q.
    constexpr int largest = 12;
    int exact = 0, all = 0;
    for (const Lattice lattice : {Lattice::tiny, Lattice::small, Lattice::flat, Lattice::line, Lattice::focus}) {
        RandomMoves random(lattice, 37);
        for (int i = 0; i < 60; ++i) {
            const Move move = random(GetParam());
            const Impact impact = move.impact();
            all += impact.meets;
            bool is_fraction = false;
            for (int q = 1; q <= largest; ++q) {
                for (int k = 0; k <= q; ++k) {
                    const bool touch = touch_at(move, k, q);
                    const double time = rounded_down(k, q);
                    if (touch) {
                        ASSERT_TRUE(impact.meets) << k << " / " << q << ": " << move;
                        ASSERT_LE(impact.toi, time) << k << " / " << q << ": " << move;
                    }
                    if (impact.meets && impact.toi == time) {
                        ASSERT_TRUE(touch) << k << " / " << q << ": " << move;
                        is_fraction = true;
                    }
                }
            }
            exact += is_fraction;
        }
    }
    EXPECT_GT(exact, 10);
    EXPECT_LE(exact, all);
}

std::string name_of(const testing::TestParamInfo<Feature>& info) {
    constexpr const char* names[] = {"VertexFace", "EdgeEdge", "VertexEdge", "VertexVertex"};
    return names[static_cast<int>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Features, ImpactBisection, testing::ValuesIn(all_features), name_of);

}  // namespace
}  // namespace crumple
