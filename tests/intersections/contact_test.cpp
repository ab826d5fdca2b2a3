#include "exact/intersection/contact.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "base/float_environment.h"
#include "crumple/crumple.h"
#include "exact/intersection/exact_intersection.h"
#include "geometry/callers_mode.h"
#include "intersections/named_pairs.h"

namespace crumple {
namespace {

std::vector<Vec3d> points_of(const Contact& c) { return {c.points.begin(), c.points.begin() + c.count}; }

/// Expects the bytes of rational arithmetic, so that −0 differs from +0.
void expect_rational_contact(const TrianglePair& pair) {
    const Contact truth = contact(intersect_rationally(pair.a, pair.b)), fast = contact(pair.a, pair.b);
    const auto bytes = static_cast<std::size_t>(truth.count) * sizeof(Vec3d);
    ASSERT_EQ(fast.count, truth.count) << pair;
    if (std::memcmp(fast.points.data(), truth.points.data(), bytes) == 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(truth.count); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(fast.points[i][axis], truth.points[i][axis]) << pair << ", point " << i << ", axis " << axis;
        }
    }
    FAIL() << "different bytes: " << pair;
}

class ContactOfEachKind : public testing::TestWithParam<Kind> {
   protected:
    RandomPairs random{GetParam(), 41};
    int rounds() const { return rounds_of(GetParam(), 25'000); }
};

TEST_P(ContactOfEachKind, matches_rational_arithmetic_byte_by_byte) {
    for (int i = 0; i < rounds(); ++i) {
        const TrianglePair pair = random();
        const CallersMode caller(i);
        const FloatEnvironment ours;
        ASSERT_NO_FATAL_FAILURE(expect_rational_contact(pair));
    }
}

INSTANTIATE_TEST_SUITE_P(All, ContactOfEachKind, testing::ValuesIn(all_kinds));

TEST(Contact, handmade_pairs_have_the_expected_points) {
    for (const NamedPair& named : named_pairs()) {
        SCOPED_TRACE(named.claim);
        EXPECT_EQ(points_of(contact(named.pair.a, named.pair.b)), named.points);
        expect_rational_contact(named.pair);
    }
}

TEST(Contact, kind_follows_the_number_of_points) {
    for (const NamedPair& named : named_pairs()) {
        const Contact found = contact(named.pair.a, named.pair.b);
        if (found.count == 0) continue;
        const ContactKind kind = found.count == 1   ? ContactKind::point
                                 : found.count == 2 ? ContactKind::segment
                                                    : ContactKind::area;
        EXPECT_EQ(found.kind(), kind) << named.claim;
    }
}

TEST(Contact, needs_rationals_for_areas_but_not_for_segments_in_general_position) {
    for (const NamedPair& named : named_pairs()) {
        const Contact found = contact(named.pair.a, named.pair.b);
        if (found.kind() == ContactKind::area) {
            EXPECT_TRUE(found.rational) << named.claim;
        }
    }
    RandomPairs random(Kind::random, 47);
    int lines = 0;
    for (int i = 0; i < 1'000; ++i) {
        const auto triangle = [&](std::array<std::int32_t, 3> names) {
            return Triangle{{random.point(), random.point(), random.point()}, names};
        };
        const Contact found = contact(triangle({0, 1, 2}), triangle({3, 4, 5}));
        EXPECT_FALSE(found.rational);
        lines += found.count == 2;
    }
    EXPECT_GT(lines, 20);
}

// Uses extruded shapes: the common line runs along an axis, so two coordinates of its ends are exactly equal, and only
// the third one orders them.
TEST(Contact, segments_parallel_to_an_axis_match_rational_arithmetic) {
    RandomPairs random(Kind::random, 43);
    int segments = 0;
    for (int i = 0; i < 6'000; ++i) {
        const int axis = i % 3;
        const auto wall = [&] {
            Vec3d p = random.point(), q = random.point(), up;
            up[axis] = random.real(1, 3);
            p[axis] -= 1;
            return Triangle{{p, q, p + up}, {0, 1, 2}};
        };
        TrianglePair pair{wall(), wall()};
        pair.b.vertex = {3, 4, 5};
        ASSERT_NO_FATAL_FAILURE(expect_rational_contact(pair));
        segments += contact(pair.a, pair.b).count == 2;
    }
    EXPECT_GT(segments, 50);
}

// Uses crossings at the middle between two float64 numbers, and so close to it that double words cannot decide.
TEST(Contact, rounds_ties_to_even) {
    for (const double last : {1.0, 3.0, 5.0}) {
        for (const double nudge : {0.0, 0x1p-60, -0x1p-60, 0x1p-120, -0x1p-120}) {
            const double low = 1, high = 1 + last * 0x1p-52;
            // x runs from low to high while z runs from −1 to 1 + nudge.
            const Triangle edge{{Vec3d{low, 0, -1}, {high, 0, 1 + nudge}, {high, 9, 1 + nudge}}, {0, 1, 2}};
            const Triangle floor{{Vec3d{-9, -1, nudge}, {9, -1, 0}, {0, 9, 0}}, {3, 4, 5}};
            expect_rational_contact({edge, floor});
            const Triangle level{{Vec3d{-9, -1, 0}, {9, -1, 0}, {0, 9, 0}}, {3, 4, 5}};
            expect_rational_contact({edge, level});
            if (nudge != 0) continue;
            // The segment is at x = 1 + last 2^-53, the middle between two float64 numbers.
            const Contact tie = contact(edge, level);
            ASSERT_EQ(tie.count, 2);
            for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(tie.points[i].x, last == 1 ? 1 : 1 + 0x1p-51);
        }
    }
}

TEST(Contact, negative_zero_becomes_positive) {
    const Triangle upright{{Vec3d{-0.0, -0.0, -1}, {-0.0, -0.0, 1}, {-0.0, 5, 1}}, {0, 1, 2}};
    const Triangle floor{{Vec3d{-4, -4, -0.0}, {4, -4, -0.0}, {0, 4, -0.0}}, {3, 4, 5}};
    const Contact found = contact(upright, floor);
    ASSERT_EQ(found.count, 2);
    for (const Vec3d& p : points_of(found)) {
        for (int axis = 0; axis < 3; ++axis) EXPECT_FALSE(std::signbit(p[axis])) << "axis " << axis;
    }
    expect_rational_contact({upright, floor});
    const Triangle corner{{Vec3d{-0.0, -0.0, -0.0}, {1, 0, 2}, {0, 1, 2}}, {0, 1, 2}};
    const Contact at_corner = contact(corner, floor);
    ASSERT_EQ(at_corner.count, 1);
    for (int axis = 0; axis < 3; ++axis) EXPECT_FALSE(std::signbit(at_corner.points[0][axis])) << "axis " << axis;
    expect_rational_contact({corner, floor});
}

/// A closed torus about z, moved, with nothing in special position.
struct Torus {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;

    Torus(std::int32_t around, std::int32_t across, const Vec3d& centre) {
        constexpr double turn = 2 * 3.14159265358979323846;
        for (std::int32_t i = 0; i < around; ++i) {
            for (std::int32_t j = 0; j < across; ++j) {
                const double a = turn * (i + 0.1) / around, b = turn * (j + 0.3) / across, r = 1 + 0.4 * std::cos(b);
                vertices.push_back(
                    {centre.x + r * std::cos(a), centre.y + r * std::sin(a), centre.z + 0.4 * std::sin(b)});
                const auto at = [&](std::int32_t u, std::int32_t v) { return u % around * across + v % across; };
                triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            }
        }
    }
    MeshView view() const { return {vertices, triangles}; }
};

TEST(Contact, segments_of_adjacent_triangles_share_bitwise_equal_ends) {
    for (const double shift : {0.0, 1e-9, 1000.0}) {
        const Torus a(40, 24, {shift, 0, 0}), b(37, 19, {shift + 0.77, 0.13, 0.21});
        Detector detector({.backend = Backend::cpu});
        const Intersections& found = detector.find({a.view(), b.view()}, {.output = Output::contacts});
        ASSERT_GT(found.pairs.size(), 300U);
        std::map<std::array<std::uint64_t, 3>, int> ends;
        for (std::size_t i = 0; i < found.pairs.size(); ++i) {
            ASSERT_EQ(found.contacts.kinds[i], ContactKind::segment);
            for (std::int64_t p = found.contacts.offsets[i]; p < found.contacts.offsets[i + 1]; ++p)
                ++ends[std::bit_cast<std::array<std::uint64_t, 3>>(found.contacts.points[static_cast<std::size_t>(p)])];
        }
        for (const auto& [point, count] : ends) ASSERT_EQ(count, 2) << "each end is that of one other segment";
    }
}

}  // namespace
}  // namespace crumple
