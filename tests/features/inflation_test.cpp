// Tests of inflated balls and boxes for queries within a distance: the balls and boxes of near triangles overlap, and
// they are hardly larger than necessary.

#include "geometry/inflation.h"

#include <gtest/gtest.h>

#include "backends/cpu/features/find_features.h"
#include "features/triangle_cases.h"
#include "geometry/ball.h"

namespace crumple {
namespace {

/// Returns the inflation for coordinates that are already normalised.
Inflation inflation_of(const MinDistance& separation) {
    PreparedScene scene;
    scene.low = {-0.75, -0.75, -0.75};
    scene.high = {0.75, 0.75, 0.75};
    const SceneFeatures features(nullptr);
    const SceneFilter rule;
    return cpu::inflation_of(
        scene, {.distance = separation.distance, .share = separation.share, .features = features, .rule = rule});
}

Ball ball_of(const TriangleCase& c, std::size_t first, const Inflation& inflation) {
    Vec3f start[3], end[3];
    for (std::size_t k = 0; k < 3; ++k) {
        start[k] = to_float(c.corner[first + k].start);
        end[k] = to_float(c.corner[first + k].end);
    }
    return swept_ball(start, end, inflation);
}

bool balls_overlap(const TriangleCase& c, const Inflation& inflation) {
    const Ball a = ball_of(c, 0, inflation), b = ball_of(c, 3, inflation);
    const Vec3d between = Vec3d{a.x, a.y, a.z} - Vec3d{b.x, b.y, b.z};
    const double sum_of_radii = static_cast<double>(a.r) + static_cast<double>(b.r);
    return dot(between, between) <= sum_of_radii * sum_of_radii;
}

// True if the boxes overlap in stage `sort`, which lowers the start of each box relative to its end by at least 20 ·
// 2^-24 times the largest coordinate of the leaf (docs/align.md).
template <int moments>
bool boxes_overlap(const cpu::FeatureTables& table, const TriangleCase& c, bool float32, const LeafFrame& frame,
                   const Inflation& inflation) {
    const LeafOfTwo<moments> leaf(table, c, float32, frame, inflation);
    const double margin = 20 * 0x1p-24 * static_cast<double>(leaf.bounds().reach) + 1e-30;
    const cpu::BoxCorner* low = leaf.boxes().low.data();
    const cpu::BoxCorner* high = leaf.boxes().high.data();
    const auto apart = [&](double from, double to) { return from > to + margin; };
    const auto behind = [&](int i, int j) {
        return apart(low[i].x, high[j].x) || apart(low[i].y, high[j].y) || apart(low[i].z, high[j].z);
    };
    return !behind(0, 1) && !behind(1, 0);
}
bool boxes_overlap(const TriangleCase& c, bool float32, const LeafFrame& frame, const Inflation& inflation) {
    const auto& tables = feature_tables();
    return std::all_of(tables.begin(), tables.end(), [&](const cpu::FeatureTables* table) {
        return c.moments == 1 ? boxes_overlap<1>(*table, c, float32, frame, inflation)
                              : boxes_overlap<2>(*table, c, float32, frame, inflation);
    });
}

const LeafFrame straight = around({});

LeafFrame any_frame(RandomCases& random) {
    const double turn = random.real(0, 6.3), tilt = random.real(0, 6.3);
    const Vec3d x{std::cos(turn), std::sin(turn), 0}, across{-std::sin(turn), std::cos(turn), 0};
    const Vec3d y = std::cos(tilt) * across + Vec3d{0, 0, std::sin(tilt)}, z = cross(x, y);
    return {{static_cast<float>(random.real(-1, 1)), 0.25f, 0}, {to_float(x), to_float(y), to_float(z)}, most};
}

class InflatedTriangles : public testing::TestWithParam<Hard> {};
INSTANTIATE_TEST_SUITE_P(, InflatedTriangles, testing::ValuesIn(all_hard), name_of_hard);

TEST_P(InflatedTriangles, near_triangles_have_overlapping_balls_and_boxes) {
    int near = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : {FeatureKind::vertex_face, FeatureKind::edge_edge})
            for (const int moments : {1, 2}) {
                RandomTriangles random(GetParam(), float32, 107);
                for (int i = 0; i < 120; ++i) {
                    TriangleCase c = random(kind, moments);
                    RandomCases& features = random.features();
                    if (moments == 2 && i % 2) {
                        const double shares[] = {0x1p-60, 0.001, 0.5, 0.99, 1 - 0x1p-30, 1 - 0x1p-53};
                        c.separation.share = shares[features.below(6)];
                        if (i % 4 == 3) c.separation.distance = 0;
                        const double part = std::ldexp(1.0, -features.below(70));
                        for (MovingPoint& p : c.corner) p.end = features.number(p.start + part * (p.end - p.start));
                    }
                    const LeafFrame frame = i % 3 ? any_frame(features) : straight;
                    const Inflation inflation = inflation_of(c.separation);
                    const bool overlap = balls_overlap(c, inflation) && boxes_overlap(c, float32, frame, inflation);
                    const bool comes_near = c.near();
                    ASSERT_TRUE(overlap || !comes_near) << c << (float32 ? ", float32" : ", float64");
                    near += comes_near;
                }
            }
    EXPECT_GT(near, 100);
}

// A path of 2^-54 is shorter than the rounding errors of corners relative to the leaf's origin. With a share of nearly
// 1 it is multiplied by 2^53.
TEST(Inflation, boxes_overlap_if_a_share_of_nearly_1_is_reached_by_a_path_of_one_rounding_error) {
    const auto rests = [](const Vec3d& p) { return MovingPoint{p, p}; };
    TriangleCase c{2, {}, {0, 1 - 0x1p-53}};
    c.corner = {MovingPoint{{0.1, 0.1, 0.3 + 0x1p-54}, {0.1, 0.1, 0.3}},
                rests({0.1, 0.2, 0.6}),
                rests({0.2, 0.1, 0.6}),
                rests({-0.5, -0.5, -0.15}),
                rests({0.7, -0.5, -0.15}),
                rests({-0.5, 0.7, -0.15})};
    ASSERT_TRUE(c.near());
    for (const float origin : {-0.3f, 0.0f, 0.1f})
        EXPECT_TRUE(boxes_overlap(c, false, around({0, 0, origin}), inflation_of(c.separation))) << origin;
}

TEST(Inflation, inflation_is_half_of_the_distance_rounded_up_but_at_most_4) {
    for (const double distance : {1e-300, 1e-38, 1e-7, 0.3, 1.0, 3.4}) {
        const Inflation inflation = inflation_of({distance, 0});
        EXPECT_GE(2 * static_cast<double>(inflation.half), distance);
        EXPECT_LE(2 * static_cast<double>(inflation.half), distance * 1.00001 + 4e-30);
        EXPECT_GE(2 * static_cast<double>(inflation(1)), distance);
        EXPECT_LE(2 * static_cast<double>(inflation(1)), distance * 1.00001 + 4e-30);
    }
    EXPECT_LE(inflation_of({1e308, 0})(1), 4);
    EXPECT_GE(2 * inflation_of({1e308, 0})(1), 3.5f);  // normalised points are at most 3.47 apart
    EXPECT_TRUE(inflation_of({0, 0}).none());
}

/// Radii of the vertices of two triangles, three each.
struct RadiiOfTwo {
    explicit RadiiOfTwo(const std::vector<double>& radii) {
        PreparedScene scene;
        scene.low = {-0.75, -0.75, -0.75};
        scene.high = {0.75, 0.75, 0.75};
        scene.triangles = {2, 0};
        scene.corners = corners.data();
        inflation = cpu::inflation_of_radii(scene, radii, workers, buffers);
    }
    double of(std::size_t triangle) const {
        return static_cast<double>(inflation.of(static_cast<std::int64_t>(triangle))(0));
    }

    static constexpr std::array<std::int32_t, 6> corners{0, 1, 2, 3, 4, 5};
    Options options{.threads = 1};
    Cancellation cancellation;
    cpu::Workers workers{options, cancellation};
    cpu::FeatureBuffers buffers{nullptr, 1, cpu::scalar_features, cpu::scalar_candidates};
    Inflation inflation;
};

TEST(InflationOfRadii, inflation_is_the_largest_radius_of_a_triangle_rounded_up) {
    for (const double radius : {0.0, 1e-300, 1e-38, 1e-7, 0.3, 1.0, 3.4}) {
        std::vector<double> radii(6, radius / 3);
        radii[1] = radius;
        radii[5] = 2 * radius;
        const RadiiOfTwo two(radii);
        EXPECT_GE(two.of(0), radius);
        EXPECT_LE(two.of(0), radius * 1.00001 + 4e-30);
        EXPECT_GE(two.of(1), std::min(4.0, 2 * radius));
        EXPECT_LE(two.of(1), 2 * radius * 1.00001 + 4e-30);
        EXPECT_EQ(two.inflation.half, std::max(two.inflation.of(0).half, two.inflation.of(1).half));
        for (std::size_t v = 0; v < 6; ++v)
            EXPECT_GE(static_cast<double>(two.buffers.vertex_radius[v]), std::min(4.0, radii[v]));
    }
    EXPECT_GE(RadiiOfTwo(std::vector<double>(6, 1e308)).of(0), 3.5) << "no two points are further apart";
    EXPECT_LE(RadiiOfTwo(std::vector<double>(6, 1e308)).of(0), 4);
}

// The radii of the two triangles add up to the distance within which they may be near.
TEST_P(InflatedTriangles, near_triangles_with_radii_have_overlapping_balls_and_boxes) {
    int near = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : {FeatureKind::vertex_face, FeatureKind::edge_edge}) {
            RandomTriangles random(GetParam(), float32, 113);
            for (int i = 0; i < 120; ++i) {
                const TriangleCase c = random(kind, 1);
                RandomCases& features = random.features();
                const double part[] = {0, 0x1p-30, 0.25, 0.5, 1};
                const double first = part[features.below(5)] * c.separation.distance;  // exact, and so is `second`
                const double second = c.separation.distance - first;
                const RadiiOfTwo radii({first, 0, first / 2, second, second, 0});
                const Ball a = ball_of(c, 0, radii.inflation.of(0)), b = ball_of(c, 3, radii.inflation.of(1));
                const Vec3d between = Vec3d{a.x, a.y, a.z} - Vec3d{b.x, b.y, b.z};
                const double sum_of_radii = static_cast<double>(a.r) + static_cast<double>(b.r);
                const LeafFrame frame = i % 3 ? any_frame(features) : straight;
                const bool overlap = dot(between, between) <= sum_of_radii * sum_of_radii &&
                                     boxes_overlap(c, float32, frame, radii.inflation);
                const bool comes_near = c.near();
                ASSERT_TRUE(overlap || !comes_near) << c << (float32 ? ", float32" : ", float64");
                near += comes_near;
            }
        }
    EXPECT_GT(near, 50);
}

// The square of the motion is flushed to zero, yet the vertex comes within the minimum distance. It moves by 6e-20; the
// minimum distance is 1 - 2^-53 times the initial distance 5e-4, which is less by 5.6e-20 only.
TEST(Inflation, boxes_still_overlap_if_the_square_of_the_motion_underflows) {
    TriangleCase c{2, {}, {0, 1 - 0x1p-53}};
    const auto at = [](double x, double y, double z) { return MovingPoint{{x, y, z}, {x, y, z}}; };
    c.corner = {at(0, 0, 0),          at(0.25, 0, -0.25),  at(0, 0.25, -0.25),
                at(-0.5, -0.5, 5e-4), at(0.5, -0.5, 5e-4), at(0, 0.5, 5e-4)};
    c.corner[0].end.z = 6e-20;
    ASSERT_TRUE(c.near());
    const Inflation inflation = inflation_of(c.separation);
    EXPECT_TRUE(balls_overlap(c, inflation));
    for (const bool float32 : {true, false}) EXPECT_TRUE(boxes_overlap(c, float32, straight, inflation));
}

// Boxes overlap if two triangles approach to exactly the given share of their distance, but not if they move slightly
// less.
TEST(Inflation, boxes_for_a_distance_share_overlap_at_the_share_but_not_just_before_it) {
    // Two triangles approach each other by 1/8 each, from the distance 1/2 to 1/4.
    TriangleCase c{2, {}, {0, 0.5}};
    const auto corner = [](double x, double y, double z, double way) {
        return MovingPoint{{x, y, z}, {x, y, z + way}};
    };
    c.corner = {corner(0.5, 0, 0, 0.125),    corner(-0.5, 0, 0, 0.125),    corner(0, 0.5, 0, 0.125),
                corner(0.5, 0, 0.5, -0.125), corner(-0.5, 0, 0.5, -0.125), corner(0, 0.5, 0.5, -0.125)};
    ASSERT_TRUE(c.near());
    EXPECT_TRUE(boxes_overlap(c, false, straight, inflation_of(c.separation)));
    for (MovingPoint& p : c.corner) p.end.z = p.start.z + 0.999 * (p.end.z - p.start.z);
    ASSERT_FALSE(c.near());
    EXPECT_FALSE(boxes_overlap(c, false, straight, inflation_of(c.separation)));
}

}  // namespace
}  // namespace crumple
