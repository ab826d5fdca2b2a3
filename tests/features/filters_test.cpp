// Tests of the filters of pairs of features, for every table of kernels (one for each instruction set): they reject
// only pairs whose distance is always above the minimum distance, and most of these.

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "base/float_environment.h"
#include "features/feature_cases.h"

namespace crumple {
namespace {

/// Points of cases, as rows that kernels read. All cases have the same kind of features and number of time samples.
class Rows {
   public:
    Rows(std::span<const FeatureCase> cases, bool float32) : ends_(4 * static_cast<std::int64_t>(cases.size())) {
        const auto moments = static_cast<std::size_t>(cases.front().moments), points = 4 * cases.size();
        auto& rows = rows_;
        rows.resize(4 * moments * points);
        for (std::size_t i = 0; i < points; ++i)
            for (std::size_t m = 0; m < moments; ++m) {
                const MovingPoint& p = cases[i / 4].point[i % 4];
                for (int axis = 0; axis < 3; ++axis)
                    rows[4 * (m * points + i) + static_cast<std::size_t>(axis)] = (m ? p.end : p.start)[axis];
            }
        if (float32) rows32_.assign(rows.begin(), rows.end());
    }

    PointRows points() const {
        return rows32_.empty() ? PointRows{nullptr, rows_.data()} : PointRows{rows32_.data(), nullptr};
    }
    std::int64_t ends() const { return ends_; }

    /// Returns, for each case, true if the filters of the table keep it. With `each`, every case has its own distance;
    /// otherwise all have that of the first case. With `flush`, subnormal numbers are 0, as in the library's calls.
    /// Devices, which compile the filters for one pair, do not flush them.
    std::vector<bool> kept(const cpu::FeatureTables& table, std::span<const FeatureCase> cases, bool flush = true,
                           bool each = false) const {
        const auto kind = static_cast<std::size_t>(cases.front().kind);
        std::vector<float> distances(cases.size() + cpu::padding);
        for (std::size_t i = 0; i < cases.size(); ++i) distances[i] = cases[i].distance;
        const cpu::RequestedDistance distance =
            each ? cpu::RequestedDistance(distances.data()) : requested_distance(cases.front());
        std::vector<FeatureTest> test;
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(cases.size()); ++i)
            test.push_back({{i, i}, {4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3}});
        std::optional<FlushToZero> mode;
        if (flush) mode.emplace();
        const std::size_t left = cases.front().moments == 1
                                     ? table.at_rest.filter[kind](points(), ends_, distance, test.data(), test.size())
                                     : table.moving.filter[kind](points(), ends_, distance, test.data(), test.size());
        std::vector<bool> kept(cases.size(), false);
        for (std::size_t i = 0; i < left; ++i) kept[static_cast<std::size_t>(test[i].pair.a)] = true;
        if (!each) {
            EXPECT_EQ((cases.front().moments == 1 ? kept_of_listed<1>(table.at_rest, cases)
                                                  : kept_of_listed<2>(table.moving, cases)),
                      kept);
        }
        return kept;
    }

    /// Returns the same as kept(), from the kernels that read vertices through the records of two triangles. Each case
    /// gets two triangles of its own.
    template <int moments>
    std::vector<bool> kept_of_listed(const cpu::FeatureKernels<moments>& kernels,
                                     std::span<const FeatureCase> cases) const {
        const FeatureKind kind = cases.front().kind;
        std::vector<FeatureRecord<moments>> rows(cases.size()), columns(cases.size());
        std::vector<std::uint32_t> packed, listed(cases.size() + cpu::padding);
        for (std::uint32_t i = 0; i < cases.size(); ++i) {
            const auto v = static_cast<std::int32_t>(4 * i), id = static_cast<std::int32_t>(i);
            FeatureRecord<moments>&a = rows[i], &b = columns[i];
            a.triangle = b.triangle = a.edge[0] = id;
            b.edge[0] = id + static_cast<std::int32_t>(cases.size());
            for (int k = 0; k < 3; ++k) {
                a.vertex[k] = v + std::min(k, 1);
                b.vertex[k] = v + (kind == FeatureKind::vertex_face ? 1 + k : 2 + std::min(k, 1));
            }
            unsigned bit = 0;
            if (kind == FeatureKind::vertex_face && i % 2) std::swap(a, b), bit = 3;
            packed.push_back(i << 16 | i);
            listed[i] = i << 4 | bit;
        }
        const cpu::PairsLeft<moments> pairs{rows.data(), columns.data(), packed.data(), packed.size()};
        cpu::TestList tests{listed.data(), cases.size()};
        std::vector<FeatureTest> test(cases.size());
        const std::size_t left = kernels.filter_list[static_cast<std::size_t>(kind)](
            points(), ends_, requested_distance(cases.front()), pairs, tests, test.data());
        std::vector<bool> kept(cases.size(), false);
        for (std::size_t i = 0; i < left; ++i) {
            const Pair& pair = test[i].pair;
            kept[static_cast<std::size_t>(kind == FeatureKind::vertex_face ? pair.b : pair.a)] = true;
        }
        return kept;
    }

   private:
    static cpu::RequestedDistance requested_distance(const FeatureCase& c) {
        return {c.distance, share_to_filter(c.share)};
    }

    std::int64_t ends_;
    std::vector<double> rows_;
    std::vector<float> rows32_;
};

bool keeps(const cpu::FeatureTables& table, const FeatureCase& c, bool float32, bool flush = true) {
    return Rows({&c, 1}, float32).kept(table, {&c, 1}, flush).front();
}

constexpr FeatureKind kinds[] = {FeatureKind::vertex_face, FeatureKind::edge_edge};

class FeatureFilters : public testing::TestWithParam<Hard> {};
INSTANTIATE_TEST_SUITE_P(, FeatureFilters, testing::ValuesIn(all_hard), name_of_hard);

TEST_P(FeatureFilters, filters_for_a_distance_share_reject_no_near_pair) {
    int rejected = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : kinds) {
            RandomCases random(GetParam(), float32, 101);
            for (int i = 0; i < 400; ++i) {
                FeatureCase c = random(kind, 2);
                // Half of them hardly move, like most features in practice.
                const double part = i % 2 ? 0x1p-6 : 1;
                for (MovingPoint& p : c.point)
                    for (int axis = 0; axis < 3; ++axis) {
                        p.end[axis] = p.start[axis] + part * (p.end[axis] - p.start[axis]);
                        if (float32) p.end[axis] = static_cast<float>(p.end[axis]);
                    }
                c.share = std::array{0.1, 0.5, 1 - 0x1p-53, 0x1p-300}[static_cast<std::size_t>(i / 2 % 4)];
                std::size_t rejecting = 0;
                for (const auto* table : feature_tables()) rejecting += !keeps(*table, c, float32);
                rejecting += !keeps(cpu::scalar_features, c, float32, false);
                ASSERT_FALSE(rejecting > 0 && c.near()) << c << (float32 ? ", float32" : ", float64");
                rejected += rejecting > 0;
            }
        }
    EXPECT_GT(rejected, 100);
}

// Tables differ only in fused operations, so they may decide differently only close to a filter's threshold, or for
// needles, where rounding alone determines the direction.
TEST_P(FeatureFilters, filters_reject_no_near_pair) {
    int cases = 0, differ = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : kinds)
            for (const int moments : {1, 2}) {
                RandomCases random(GetParam(), float32, 83);
                for (int i = 0; i < 1000; ++i) {
                    const FeatureCase c = random(kind, moments);
                    std::size_t rejecting = 0;
                    for (const auto* table : feature_tables()) rejecting += !keeps(*table, c, float32);
                    rejecting += !keeps(cpu::scalar_features, c, float32, false);
                    ASSERT_FALSE(rejecting > 0 && c.near()) << c << (float32 ? ", float32" : ", float64");
                    ++cases;
                    differ += rejecting > 0 && rejecting <= feature_tables().size();
                }
            }
    EXPECT_LE(differ, cases / (GetParam() == Hard::needles ? 50 : 500));
}

TEST(FeatureFilterBatches, pairs_in_a_batch_are_filtered_like_single_pairs) {
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : kinds)
            for (const int moments : {1, 2}) {
                RandomCases random(Hard::random, float32, 101);
                std::vector<FeatureCase> cases;
                for (int i = 0; i < 67; ++i) {
                    cases.push_back(random(kind, moments));
                    cases.back().distance = 0.05f;
                }
                const Rows rows(cases, float32);
                for (const auto* table : feature_tables()) {
                    const std::vector<bool> kept = rows.kept(*table, cases);
                    for (std::size_t i = 0; i < cases.size(); ++i)
                        ASSERT_EQ(kept[i], keeps(*table, cases[i], float32)) << cases[i];
                }
            }
}

TEST(FeatureFilterBatches, pairs_in_a_batch_are_filtered_by_their_own_distances) {
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : kinds) {
            RandomCases random(Hard::opposite, float32, 109);
            std::vector<FeatureCase> cases;
            for (int i = 0; i < 1003; ++i) cases.push_back(random(kind, 1));
            const Rows rows(cases, float32);
            for (const auto* table : feature_tables()) {
                const std::vector<bool> kept = rows.kept(*table, cases, true, true);
                EXPECT_EQ(std::count(kept.begin(), kept.end(), true) % 1003 != 0, true) << "some are kept";
                for (std::size_t i = 0; i < cases.size(); ++i)
                    ASSERT_EQ(kept[i], keeps(*table, cases[i], float32)) << cases[i];
            }
        }
}

void expect_rejected(const FeatureCase& c) {
    for (const auto* table : feature_tables()) {
        EXPECT_FALSE(keeps(*table, c, true)) << c;
        EXPECT_FALSE(keeps(*table, c, false)) << c;
    }
}

// All points of one feature are below all of the other along an axis, by at least 0.1.
TEST(FeatureFilterRejection, features_apart_along_a_coordinate_axis_are_rejected) {
    RandomCases random(Hard::random, true, 103);
    for (int i = 0; i < 400; ++i) {
        FeatureCase c = random(kinds[i % 2], 1 + i / 2 % 2);
        const int axis = i % 3;
        const std::size_t first = c.kind == FeatureKind::vertex_face ? 1 : 2;
        const double up = i % 5 < 2 ? 1 : -1;
        for (std::size_t k = 0; k < 4; ++k)
            for (Vec3d* p : {&c.point[k].start, &c.point[k].end})
                (*p)[axis] = (k < first ? up : -up) * (0.05 + 0.5 * std::abs((*p)[axis]));
        c.distance = i % 7 < 3 ? 0 : 0.099f;
        expect_rejected(c);
    }
}

constexpr Vec3d u{0.6, 0.125, 0.25}, v{-0.25, 0.5, 0.125};
Vec3d normal() { return (1 / std::sqrt(dot(cross(u, v), cross(u, v)))) * cross(u, v); }

/// A vertex above a face, or an edge above an edge; their boxes overlap, and so do their projections onto the line
/// through their centres.
FeatureCase stacked(FeatureKind kind, double height) {
    const Vec3d h = height * normal();
    if (kind == FeatureKind::vertex_face)
        return {kind, 1, {{{0.75 * u + h, {}}, {u, {}}, {v, {}}, {-1.0 * u - v, {}}}}};
    return {kind, 1, {{{-1.0 * u, {}}, {u, {}}, {0.75 * u - 0.125 * v + h, {}}, {0.75 * u + v + h, {}}}}};
}

TEST(FeatureFilterRejection, features_apart_along_the_normal_of_a_face_or_edge_pair_are_rejected) {
    for (const FeatureKind kind : kinds)
        for (const double height : {0.01, -0.01})
            for (const float distance : {0.0f, 0.0099f}) {
                FeatureCase c = stacked(kind, height);
                c.distance = distance;
                expect_rejected(c);
            }
}

TEST(FeatureFilterRejection, nearly_translating_features_that_are_never_coplanar_are_rejected) {
    for (const FeatureKind kind : kinds)
        for (const double height : {0.01, -0.01}) {
            FeatureCase c = stacked(kind, height);
            c.moments = 2;
            for (std::size_t k = 0; k < 4; ++k)
                c.point[k].end = c.point[k].start + Vec3d{0.125, 0.0625, -0.125 + 0.001 * static_cast<double>(k)};
            expect_rejected(c);
        }
}

// At one end of the step the vertex is above the centre of the face. The direction between their centres at that time
// is the face's normal, which separates them throughout. The direction between their centres at the other end does not.
TEST(FeatureFilterRejection, moving_vertex_apart_along_the_normal_of_a_static_face_is_rejected) {
    const Vec3d n = normal();
    FeatureCase c = stacked(FeatureKind::vertex_face, 0.02);
    c.moments = 2;
    c.distance = 0.01f;
    for (std::size_t k = 1; k < 4; ++k) c.point[k].end = c.point[k].start;
    c.point[0].end = 0.3 * n;
    expect_rejected(c);
    for (MovingPoint& p : c.point) std::swap(p.start, p.end);
    expect_rejected(c);
}

const Vec3d e = 1 / std::sqrt(3) * Vec3d{1, 1, 1}, f = 1 / std::sqrt(2) * Vec3d{1, -1, 0};

/// In one plane, a vertex next to an edge of a face, or an edge that starts next to another one: their boxes overlap,
/// and so do their projections onto the line through their centres. `edge`: index of the face's edge, or of the edge
/// that the other one starts next to.
FeatureCase beside_an_edge(FeatureKind kind, std::size_t edge) {
    if (kind == FeatureKind::edge_edge) {
        FeatureCase c{kind, 1, {{{-1.0 * e, {}}, {e, {}}, {0.8 * e + 0.02 * f, {}}, {0.2 * e + 0.5 * f, {}}}}};
        if (edge == 1) std::swap(c.point[0], c.point[2]), std::swap(c.point[1], c.point[3]);
        return c;
    }
    FeatureCase c{kind, 1, {{{0.9 * e + 0.02 * f, {}}, {-1.0 * e, {}}, {e, {}}, {-0.5 * e - f, {}}}}};
    std::rotate(c.point.begin() + 1, c.point.begin() + 1 + static_cast<std::ptrdiff_t>(edge), c.point.end());
    return c;
}

TEST(FeatureFilterRejection, coplanar_features_apart_across_an_edge_are_rejected) {
    for (const FeatureKind kind : kinds)
        for (std::size_t edge = 0; edge < (kind == FeatureKind::vertex_face ? 3 : 2); ++edge) {
            FeatureCase c = beside_an_edge(kind, edge);
            for (const float distance : {0.0f, 0.019f}) {
                c.distance = distance;
                expect_rejected(c);
            }
            c.distance = 0.021f;
            EXPECT_TRUE(c.near());
        }
}

// During the step the features are scaled in their plane and moved along its normal. The direction across the edge
// separates them at both ends.
TEST(FeatureFilterRejection, moving_coplanar_features_apart_across_an_edge_are_rejected) {
    for (const FeatureKind kind : kinds)
        for (std::size_t edge = 0; edge < (kind == FeatureKind::vertex_face ? 3 : 2); ++edge) {
            FeatureCase c = beside_an_edge(kind, edge);
            c.moments = 2;
            for (MovingPoint& p : c.point) p.end = {0.5 * dot(p.start, e) + 0.1, 0.3 * dot(p.start, f) - 0.2, 0.25};
            for (MovingPoint& p : c.point) p.end = p.end.x * e + p.end.y * f + p.end.z * cross(e, f);
            expect_rejected(c);
            for (MovingPoint& p : c.point) std::swap(p.start, p.end);
            expect_rejected(c);
        }
}

}  // namespace
}  // namespace crumple
