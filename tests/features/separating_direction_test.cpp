// Tests of the filter that drops pairs of triangles which a direction separates, for every table of kernels (one for
// each instruction set): dropped pairs have no near features, and most pairs without near features are dropped. A
// triangle is "big" if its coordinates exceed a limit of the leaf (LeafFrame::big).

#include <gtest/gtest.h>

#include "features/triangle_cases.h"
#include "filters/features/feature_filters.h"
#include "filters/features/separating_direction.h"

namespace crumple {
namespace {

/// Returns the number of tables of kernels that drop the pair. `frame`: frame of the leaf, whose only members are the
/// two triangles.
template <int moments>
std::size_t dropping(const TriangleCase& c, bool float32, const LeafFrame& frame) {
    std::size_t count = 0;
    for (const auto* table : feature_tables()) {
        const LeafOfTwo<moments> leaf(*table, c, float32, frame, {});
        count += !leaf.kept(
            {static_cast<float>(c.separation.distance), leaf.bounds().reach, share_to_filter(c.separation.share)});
    }
    return count;
}
std::size_t dropping(const TriangleCase& c, bool float32, const LeafFrame& frame) {
    return c.moments == 1 ? dropping<1>(c, float32, frame) : dropping<2>(c, float32, frame);
}

class SeparatedTriangles : public testing::TestWithParam<Hard> {};
INSTANTIATE_TEST_SUITE_P(, SeparatedTriangles, testing::ValuesIn(all_hard), name_of_hard);

TEST_P(SeparatedTriangles, dropped_pairs_have_no_near_features) {
    int cases = 0, differ = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : {FeatureKind::vertex_face, FeatureKind::edge_edge})
            for (const int moments : {1, 2}) {
                RandomTriangles random(GetParam(), float32, 89);
                for (int i = 0; i < 250; ++i) {
                    const TriangleCase c = random(kind, moments);
                    const Vec3f corner = to_float(c.corner[static_cast<std::size_t>(i % 6)].start);
                    const LeafFrame frame = around(i % 3 == 0 ? Vec3f{} : i % 3 == 1 ? corner : Vec3f{0.25f, -1, 0.5f});
                    const std::size_t drop = dropping(c, float32, frame);
                    ASSERT_FALSE(drop > 0 && c.near()) << c << (float32 ? ", float32" : ", float64");
                    ++cases;
                    differ += drop > 0 && drop < feature_tables().size();
                }
            }
    EXPECT_LE(differ, cases / 500);
}

TEST_P(SeparatedTriangles, dropped_pairs_do_not_come_within_the_distance_share) {
    int dropped = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : {FeatureKind::vertex_face, FeatureKind::edge_edge}) {
            RandomTriangles random(GetParam(), float32, 103);
            for (int i = 0; i < 150; ++i) {
                TriangleCase c = random(kind, 2);
                const double part = i % 2 ? 0x1p-6 : 1;
                for (MovingPoint& p : c.corner)
                    for (int axis = 0; axis < 3; ++axis) {
                        p.end[axis] = p.start[axis] + part * (p.end[axis] - p.start[axis]);
                        if (float32) p.end[axis] = static_cast<float>(p.end[axis]);
                    }
                c.separation.share = std::array{0.05, 0.3, 1 - 0x1p-53}[static_cast<std::size_t>(i / 2 % 3)];
                const LeafFrame frame = around(i % 4 < 2 ? Vec3f{} : Vec3f{0.25f, -1, 0.5f});
                const std::size_t drop = dropping(c, float32, frame);
                ASSERT_FALSE(drop > 0 && c.near()) << c << (float32 ? ", float32" : ", float64");
                dropped += drop > 0;
            }
        }
    if (GetParam() == Hard::random) {
        EXPECT_GT(dropped, 20);
    }
}

// Gives the first of two triangles around a hard pair of features one or two corners of the second. They replace
// corners that do not belong to the hard pair.
TEST_P(SeparatedTriangles, dropped_pairs_with_common_corners_have_no_near_features) {
    int cases = 0, near = 0, dropped = 0, differ = 0;
    for (const bool float32 : {true, false})
        for (const FeatureKind kind : {FeatureKind::vertex_face, FeatureKind::edge_edge})
            for (const int moments : {1, 2}) {
                RandomTriangles random(GetParam(), float32, 101);
                for (std::size_t i = 0; i < 400; ++i) {
                    TriangleCase c = random(kind, moments);
                    c.share(2, 3 + i % 3);
                    if (kind == FeatureKind::vertex_face && i % 4 == 0) c.share(1, 3 + (i + 1) % 3);
                    const LeafFrame frame = around(i % 2 ? to_float(c.corner[i % 6].start) : Vec3f{});
                    const std::size_t drop = dropping(c, float32, frame);
                    ASSERT_FALSE(drop > 0 && c.near()) << c << (float32 ? ", float32" : ", float64");
                    ++cases;
                    near += c.near();
                    dropped += drop == feature_tables().size();
                    differ += drop > 0 && drop < feature_tables().size();
                }
            }
    EXPECT_LE(differ, cases / 500);
    EXPECT_GT(near, cases / 100);
    EXPECT_GT(dropped, GetParam() == Hard::random ? cases / 100 : 0) << near;
}

MovingPoint static_point(const Vec3d& p) { return {p, p}; }

/// Returns two triangles with a common corner, in a tilted plane, with sides of length 1/2: the first spans 0 to 60
/// degrees, the second `from` to `to`. Both move by `way`.
TriangleCase fan(double from, double to, const Vec3d& way, double distance) {
    const Vec3d u{0.48, 0.6, 0.64}, v{0.8, -0.6, 0}, at{-0.2, 0.1, -0.3};  // unit vectors at a right angle
    const auto rim = [&](double degrees) {
        const double angle = degrees * 3.14159265358979 / 180;
        const Vec3d p = at + 0.5 * std::cos(angle) * u + 0.5 * std::sin(angle) * v;
        return MovingPoint{p, p + way};
    };
    TriangleCase c{2, {rim(0), rim(60), {at, at + way}, rim(from), {at, at + way}, rim(to)}, {distance, 0}};
    c.share(2, 4);
    return c;
}

TEST(TrianglesApart, triangles_on_either_side_of_a_common_corner_are_dropped) {
    for (const double distance : {0.0, 0.2})
        for (const int moments : {1, 2})
            for (const double from : {120.0, 150.0, 180.0}) {
                TriangleCase c = fan(from, from + 60, {0.1, 0.2, 0.05}, distance);
                c.moments = moments;
                EXPECT_FALSE(c.near());
                EXPECT_EQ(dropping(c, false, around({})), feature_tables().size()) << from << ' ' << distance;
                std::swap(c.corner[3], c.corner[5]);
                std::swap(c.vertex[3], c.vertex[5]);
                EXPECT_EQ(dropping(c, false, around({})), feature_tables().size()) << from << ' ' << distance;
            }
}

// Directions at the common corner separate the triangles by more than 0.2, but not by 0.3.
TEST(TrianglesApart, triangles_too_close_at_a_common_corner_are_not_dropped) {
    EXPECT_EQ(dropping(fan(120, 180, {}, 0.2), false, around({})), feature_tables().size());
    const TriangleCase c = fan(120, 180, {}, 0.3);
    EXPECT_EQ(dropping(c, false, around({})), 0U);
    EXPECT_EQ(dropping(fan(30, 90, {}, 0), false, around({})), 0U);  // they overlap
}

// During the step the second triangle turns about the common corner to the place of the first one.
TEST(TrianglesApart, triangles_that_meet_by_turning_about_a_common_corner_are_kept) {
    TriangleCase c = fan(150, 210, {}, 0);
    const TriangleCase end = fan(30, 90, {}, 0);
    for (std::size_t k = 3; k < 6; ++k) c.corner[k].end = end.corner[k].end;
    ASSERT_TRUE(c.near());
    EXPECT_EQ(dropping(c, false, around({})), 0U);
    for (MovingPoint& p : c.corner) std::swap(p.start, p.end);
    EXPECT_EQ(dropping(c, false, around({})), 0U);
}

// Triangles with a common side are not dropped, even if they lie on opposite sides of it and no features are near.
TEST(TrianglesApart, triangles_with_a_common_side_are_not_dropped) {
    TriangleCase c = fan(60, 120, {}, 0);
    c.share(1, 3);
    EXPECT_FALSE(c.near());
    EXPECT_EQ(dropping(c, false, around({})), 0U);
}

TEST(TrianglesApart, big_triangle_with_a_common_corner_is_not_dropped) {
    const TriangleCase c = fan(150, 210, {}, 0);
    ASSERT_EQ(dropping(c, false, around({})), feature_tables().size());
    EXPECT_EQ(dropping(c, false, around({}, 0.55f)), 0U);
}

// The centres are so close that the square of their difference is flushed to zero, so that no gap can be measured along
// it.
TEST(TrianglesApart, triangles_with_almost_equal_centres_are_not_dropped) {
    TriangleCase c{1, {}, {1e-3, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d p{k == 0 ? 0.25 : -0.125, k == 1 ? 0.25 : -0.125, 0};
        c.corner[k] = static_point(p + Vec3d{0, 0, 1.1e-19});
        c.corner[3 + k] = static_point(p + Vec3d{0, 0, 1.4e-19});
    }
    ASSERT_TRUE(c.near());
    EXPECT_EQ(dropping(c, false, around({})), 0U);
    c.moments = 2;
    EXPECT_EQ(dropping(c, false, around({})), 0U);
}

/// Returns a tilted triangle, and another one `height` above it whose box is within the first one's; both move by
/// `way`.
TriangleCase stacked(double height, const Vec3d& shift, const Vec3d& way, double distance) {
    const Vec3d u{0.6, 0.1, 0.3}, v{-0.2, 0.5, 0.2}, n = (1 / std::sqrt(dot(cross(u, v), cross(u, v)))) * cross(u, v);
    TriangleCase c{2, {}, {distance, 0}};
    const std::array<Vec3d, 3> lower{u, v, -1.0 * u - v};
    for (std::size_t k = 0; k < 3; ++k) {
        c.corner[k] = {lower[k], lower[k] + way};
        const Vec3d p = 0.2 * lower[k] + shift + height * n;
        c.corner[3 + k] = {p, p + way};
    }
    return c;
}

TEST(TrianglesApart, triangles_separated_by_a_normal_are_dropped) {
    const Vec3d u{0.6, 0.1, 0.3};
    for (const double distance : {0.0, 0.009})
        for (int moments : {1, 2}) {
            TriangleCase c = stacked(0.01, 0.7 * u, {0.05, -0.1, 0.2}, distance);
            c.moments = moments;
            EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
            for (std::size_t k = 0; k < 3; ++k) std::swap(c.corner[k], c.corner[3 + k]);
            EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
        }
}

// Both triangles are tilted at the start. At the end one of them is not tilted, and only its normal separates the
// triangles at both times.
TEST(TrianglesApart, triangles_separated_by_a_start_or_end_normal_are_dropped) {
    const Vec3d u{0.6, 0.1, 0.3}, v{-0.2, 0.5, 0.2}, n = (1 / std::sqrt(dot(cross(u, v), cross(u, v)))) * cross(u, v);
    const double at_start[] = {0, 0.1, 0.3}, at_end[] = {0.3, 0.2, 0};
    for (const bool lower : {true, false}) {
        TriangleCase c = stacked(0.01, 0.7 * u, {0.05, -0.1, 0.2}, 0.005);
        for (std::size_t k = 0; k < 3; ++k) {
            MovingPoint &below = c.corner[k], &above = c.corner[3 + k];
            below.start = below.start - at_start[k] * n;
            above.start = above.start + at_start[2 - k] * n;
            if (lower)
                above.end = above.end + at_end[k] * n;
            else
                below.end = below.end - at_end[k] * n;
        }
        EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
        for (MovingPoint& p : c.corner) std::swap(p.start, p.end);
        EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
    }
}

// One triangle tilts about the x axis by an eighth of a turn during the step. The normal of the other one separates the
// triangles throughout.
TEST(TrianglesApart, triangles_that_stay_apart_while_one_tilts_are_dropped) {
    TriangleCase c{2, {}, {0.05, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        const double x = k == 0 ? 0.6 : -0.3, y = k == 1 ? 0.6 : -0.3;
        // A lies flat at the start and is tilted at the end, below z = 0.1; B stays above all that.
        c.corner[k] = {{x, y, 0}, {x, 0.1 * y, 0.1 * y}};
        c.corner[3 + k] = {{0.5 * x + 0.4, 0.5 * y, 0.3}, {x, y, 0.31}};
    }
    EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
    for (MovingPoint& p : c.corner) std::swap(p.start, p.end);
    EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
}

TEST(TrianglesApart, more_than_half_of_separate_random_triangles_are_dropped) {
    for (const int moments : {1, 2}) {
        RandomTriangles random(Hard::random, true, 97);
        std::size_t apart = 0, dropped = 0;
        for (int i = 0; i < 400; ++i) {
            TriangleCase c = random(FeatureKind::vertex_face, moments);
            c.separation = {};
            for (MovingPoint& p : c.corner) p = {0.5 * p.start, 0.5 * p.end};
            for (std::size_t k = 3; k < 6; ++k) c.corner[k].start.x += 0.4, c.corner[k].end.x += 0.4;
            apart += !c.near();
            dropped += dropping(c, false, around({})) == feature_tables().size();
        }
        EXPECT_GT(apart, 100U);
        EXPECT_GT(dropped, apart / 2) << moments;
    }
}

TEST(TrianglesApart, pairs_with_a_big_triangle_are_not_dropped) {
    TriangleCase c = stacked(0.2, {}, {}, 0);
    ASSERT_EQ(dropping(c, false, around({})), feature_tables().size());
    EXPECT_EQ(dropping(c, false, around({}, 0.4f)), 0U);  // the lower triangle is big
    c.moments = 1;
    ASSERT_EQ(dropping(c, false, around({})), feature_tables().size());
    EXPECT_EQ(dropping(c, false, around({}, 0.4f)), 0U);
}

}  // namespace
}  // namespace crumple
