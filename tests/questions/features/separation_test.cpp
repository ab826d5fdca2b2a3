// Pairs of triangles that a direction separates, by every table of kernels: none has a pair of features that is an
// answer, and most that are apart go.

#include <gtest/gtest.h>

#include "questions/features/separation.h"
#include "questions/features/triangle_cases.h"

namespace crumple {
namespace {

/// How many tables drop the pair; `frame`: of their leaf, in which there is nothing else.
template <int moments>
std::size_t dropping(const TriangleCase& c, bool float32, const LeafFrame& frame) {
    std::size_t count = 0;
    for (const auto* table : feature_tables()) {
        const LeafOfTwo<moments> leaf(*table, c, float32, frame, {});
        count += !leaf.kept(needed_gap(static_cast<float>(c.separation.distance), leaf.bounds().reach));
    }
    return count;
}
std::size_t dropping(const TriangleCase& c, bool float32, const LeafFrame& frame) {
    return c.moments == 1 ? dropping<1>(c, float32, frame) : dropping<2>(c, float32, frame);
}

class SeparatedTriangles : public testing::TestWithParam<Hard> {};
INSTANTIATE_TEST_SUITE_P(, SeparatedTriangles, testing::ValuesIn(all_hard), name_of_hard);

TEST_P(SeparatedTriangles, HaveNoFeaturesThatAreAnAnswer) {
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

MovingPoint at_rest(const Vec3d& p) { return {p, p}; }

// Middles so close that the square of what lies between them is flushed to zero: no length to measure a gap in.
TEST(TrianglesApart, AreNotThoseWhoseMiddlesAreNext) {
    TriangleCase c{1, {}, {1e-3, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d p{k == 0 ? 0.25 : -0.125, k == 1 ? 0.25 : -0.125, 0};
        c.corner[k] = at_rest(p + Vec3d{0, 0, 1.1e-19});
        c.corner[3 + k] = at_rest(p + Vec3d{0, 0, 1.4e-19});
    }
    ASSERT_TRUE(c.near());
    EXPECT_EQ(dropping(c, false, around({})), 0U);
    c.moments = 2;
    EXPECT_EQ(dropping(c, false, around({})), 0U);
}

/// A tilted triangle, and one `height` above it whose box is within its own, as both move.
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

TEST(TrianglesApart, AreThoseThatANormalSeparates) {
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

// Tilted at the start; at the end one of them is not, and only its normal there separates them at both.
TEST(TrianglesApart, AreThoseThatANormalOfEitherEndSeparates) {
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

// Turned by a quarter about the x axis on the way, so that what separates at the one end is told at the other.
TEST(TrianglesApart, AreThoseThatADirectionOfEitherEndSeparates) {
    TriangleCase c{2, {}, {0.05, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
        const double x = k == 0 ? 0.6 : -0.3, y = k == 1 ? 0.6 : -0.3;
        // A lies flat at the start and stands at the end, at y = 0 and below z = 0.1; B is a slab above all that.
        c.corner[k] = {{x, y, 0}, {x, 0.1 * y, 0.1 * y}};
        c.corner[3 + k] = {{0.5 * x + 0.4, 0.5 * y, 0.3}, {x, y, 0.31}};
    }
    EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
    for (MovingPoint& p : c.corner) std::swap(p.start, p.end);
    EXPECT_EQ(dropping(c, false, around({})), feature_tables().size());
}

TEST(TrianglesApart, AreMostOfThoseThatAreApart) {
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

TEST(TrianglesApart, AreNoneWithABigMember) {
    TriangleCase c = stacked(0.2, {}, {}, 0);
    ASSERT_EQ(dropping(c, false, around({})), feature_tables().size());
    EXPECT_EQ(dropping(c, false, around({}, 0.4f)), 0U);  // the lower one is
    c.moments = 1;
    ASSERT_EQ(dropping(c, false, around({})), feature_tables().size());
    EXPECT_EQ(dropping(c, false, around({}, 0.4f)), 0U);
}

// A share of the distance at the start is no distance that is known here.
TEST(TrianglesApart, AreNoneWhereTheGapIsEndless) {
    for (const double scale : {1.0, 1e-19, 1e-30}) {
        TriangleCase c = stacked(0.5, {}, {}, 0);
        for (MovingPoint& p : c.corner) p = {scale * p.start, scale * p.end};
        for (const auto* table : feature_tables())
            EXPECT_TRUE(LeafOfTwo<2>(*table, c, false, around({}), {}).kept(most));
    }
}

}  // namespace
}  // namespace crumple
