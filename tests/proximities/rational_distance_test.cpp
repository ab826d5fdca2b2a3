// Tests on handmade features with evident distances, for every way in which they can be degenerate, and at the borders
// of rounding.

#include "exact/proximity/rational_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "proximities/feature_builders.h"

namespace crumple {
namespace {

constexpr double least_float = std::numeric_limits<double>::denorm_min(),
                 largest_float = std::numeric_limits<double>::max(), infinity = std::numeric_limits<double>::infinity();

template <class Type>
ClosestPoints closest(Type type, double first, double second) {
    return {static_cast<std::uint8_t>(type), {first, second}};
}

template <class Type>
void expect(const Features& features, double squared, Type type, double first, double second) {
    const RationalDistance distance(features);
    EXPECT_EQ(distance.squared(), squared) << features;
    EXPECT_EQ(distance.touching(), squared == 0) << features;
    EXPECT_EQ(distance.closest(), closest(type, first, second)) << features;
}

// Returns a vertex and the face with corners (0, 0, 0), (4, 0, 0), (0, 4, 0).
Features to_face(const Vec3d& p) { return vertex_face(p, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}); }

TEST(VertexFaceDistance, closest_point_inside_a_face_is_reported_as_such) {
    using enum VertexFaceType;
    expect(to_face({1, 2, 3}), 9, P_T, 0.25, 0.5);
    expect(to_face({1, 2, -3}), 9, P_T, 0.25, 0.5);
    expect(to_face({1, 2, 0}), 0, P_T, 0.25, 0.5);
    expect(to_face({least_float, 1, 0}), 0, P_T, 0, 0.25);  // its u rounds to 0, and yet it is inside
}

TEST(VertexFaceDistance, is_measured_to_the_edges) {
    using enum VertexFaceType;
    expect(to_face({1, -2, 3}), 13, P_E0, 0.25, 0);
    expect(to_face({-2, 3, 3}), 13, P_E2, 0, 0.75);
    expect(to_face({4, 2, 0}), 2, P_E1, 0.75, 0.25);
    // For a vertex above an edge, or on it, the closest part is the edge and not the face.
    expect(to_face({1, 0, 3}), 9, P_E0, 0.25, 0);
    expect(to_face({1, 3, 0}), 0, P_E1, 0.25, 0.75);
}

TEST(VertexFaceDistance, is_measured_to_the_corners) {
    using enum VertexFaceType;
    expect(to_face({-1, -2, 2}), 9, P_T0, 0, 0);
    expect(to_face({6, -1, 0}), 5, P_T1, 1, 0);
    expect(to_face({0, 7, 4}), 25, P_T2, 0, 1);
    expect(to_face({4, 0, 0}), 0, P_T1, 1, 0);
    expect(to_face({4, 0, 2}), 4, P_T1, 1, 0);
}

TEST(VertexFaceDistance, is_measured_to_collapsed_faces) {
    using enum VertexFaceType;
    const Vec3d o{0, 0, 0}, x{4, 0, 0}, half{2, 0, 0};
    // Corners on one line, each of them once in the middle: the first edge that contains the closest point is reported.
    expect(vertex_face({1, 0, 2}, o, x, half), 4, P_E0, 0.25, 0);
    expect(vertex_face({1, 0, 2}, half, x, o), 4, P_E1, 0.25, 0.75);
    expect(vertex_face({1, 0, 2}, o, half, x), 4, P_E0, 0.5, 0);
    expect(vertex_face({3, 0, 2}, o, half, x), 4, P_E1, 0.5, 0.5);
    expect(vertex_face({2, 0, 2}, o, x, half), 4, P_T2, 0, 1);
    expect(vertex_face({5, 0, 0}, o, half, x), 1, P_T2, 0, 1);
    // Two equal corners: the first of them is reported.
    expect(vertex_face({5, 0, 0}, o, x, x), 1, P_T1, 1, 0);
    expect(vertex_face({1, 1, 0}, o, x, x), 1, P_E0, 0.25, 0);
    expect(vertex_face({1, 1, 0}, x, x, o), 1, P_E1, 0.25, 0.75);
    expect(vertex_face({5, 0, 0}, x, x, o), 1, P_T0, 0, 0);
    // A point.
    expect(vertex_face({5, 0, 0}, x, x, x), 1, P_T0, 0, 0);
    expect(vertex_face(x, x, x, x), 0, P_T0, 0, 0);
}

TEST(EdgeEdgeDistance, crossing_edges_are_measured_between_inner_points) {
    using enum EdgeEdgeType;
    expect(edge_edge({0, 0, 0}, {4, 0, 0}, {1, -1, 3}, {1, 7, 3}), 9, EA_EB, 0.25, 0.125);
    expect(edge_edge({0, 0, 0}, {4, 0, 0}, {1, -1, 0}, {1, 7, 0}), 0, EA_EB, 0.25, 0.125);
}

TEST(EdgeEdgeDistance, distance_is_measured_from_an_end_to_an_inner_point) {
    using enum EdgeEdgeType;
    const Vec3d o{0, 0, 0}, x{4, 0, 0};
    expect(edge_edge(o, x, {1, 1, 2}, {2, 5, 9}), 5, EA_EB0, 0.25, 0);
    expect(edge_edge(o, x, {2, 5, 9}, {1, 1, 2}), 5, EA_EB1, 0.25, 1);
    expect(edge_edge({1, 1, 2}, {2, 5, 9}, o, x), 5, EA0_EB, 0, 0.25);
    expect(edge_edge({2, 5, 9}, {1, 1, 2}, o, x), 5, EA1_EB, 1, 0.25);
    // The closest point of the second line is exactly its end.
    expect(edge_edge(o, x, {1, 0, 2}, {1, 5, 2}), 4, EA_EB0, 0.25, 0);
}

TEST(EdgeEdgeDistance, is_measured_between_ends) {
    using enum EdgeEdgeType;
    const Vec3d o{0, 0, 0}, x{4, 0, 0}, near{5, 1, 1}, far{9, 2, 3};
    expect(edge_edge(x, o, near, far), 3, EA0_EB0, 0, 0);
    expect(edge_edge(x, o, far, near), 3, EA0_EB1, 0, 1);
    expect(edge_edge(o, x, near, far), 3, EA1_EB0, 1, 0);
    expect(edge_edge(o, x, far, near), 3, EA1_EB1, 1, 1);
}

TEST(EdgeEdgeDistance, parallel_edges_report_the_first_of_the_smallest_closest_parts) {
    using enum EdgeEdgeType;
    const auto at = [](double from, double to, double y) { return std::array{Vec3d{from, y, 0}, Vec3d{to, y, 0}}; };
    const auto expect_pair = [&](std::array<Vec3d, 2> first, std::array<Vec3d, 2> second, EdgeEdgeType type, double s,
                                 double t) {
        expect(edge_edge(first[0], first[1], second[0], second[1]), 9, type, s, t);
    };
    expect_pair(at(0, 4, 0), at(0, 4, 3), EA0_EB0, 0, 0);
    expect_pair(at(0, 4, 0), at(4, 0, 3), EA0_EB1, 0, 1);
    expect_pair(at(0, 4, 0), at(4, 8, 3), EA1_EB0, 1, 0);
    expect_pair(at(0, 4, 0), at(9, 4, 3), EA1_EB1, 1, 1);
    expect_pair(at(0, 4, 0), at(1, 5, 3), EA_EB0, 0.25, 0);
    expect_pair(at(0, 4, 0), at(1, 2, 3), EA_EB0, 0.25, 0);
    expect_pair(at(0, 4, 0), at(-1, 3, 3), EA_EB1, 0.75, 1);
    expect_pair(at(1, 2, 0), at(0, 4, 3), EA0_EB, 0, 0.25);
    expect_pair(at(1, 5, 0), at(0, 4, 3), EA_EB1, 0.75, 1);
    // On one line.
    expect(edge_edge({0, 0, 0}, {4, 0, 0}, {6, 0, 0}, {9, 0, 0}), 4, EA1_EB0, 1, 0);
    expect(edge_edge({0, 0, 0}, {4, 0, 0}, {9, 0, 0}, {1, 0, 0}), 0, EA_EB1, 0.25, 1);
}

TEST(EdgeEdgeDistance, is_measured_to_collapsed_edges) {
    using enum EdgeEdgeType;
    const Vec3d o{0, 0, 0}, x{4, 0, 0}, p{1, 2, 0}, q{5, 0, 0};
    expect(edge_edge(o, x, p, p), 4, EA_EB0, 0.25, 0);
    expect(edge_edge(p, p, o, x), 4, EA0_EB, 0, 0.25);
    expect(edge_edge(o, x, q, q), 1, EA1_EB0, 1, 0);
    expect(edge_edge(q, q, o, x), 1, EA0_EB1, 0, 1);
    expect(edge_edge(p, p, q, q), 20, EA0_EB0, 0, 0);
    expect(edge_edge(p, p, p, p), 0, EA0_EB0, 0, 0);
}

TEST(VertexEdgeDistance, distance_is_measured_to_an_inner_point_or_an_end) {
    using enum VertexEdgeType;
    const Vec3d o{0, 0, 0}, x{4, 0, 0};
    expect(vertex_edge({1, 2, 2}, o, x), 8, P_E, 0.25, 0);
    expect(vertex_edge({-1, 2, 2}, o, x), 9, P_E0, 0, 0);
    expect(vertex_edge({0, 2, 2}, o, x), 8, P_E0, 0, 0);
    expect(vertex_edge({5, 2, 2}, o, x), 9, P_E1, 1, 0);
    expect(vertex_edge({3, 0, 0}, o, x), 0, P_E, 0.75, 0);
    expect(vertex_edge({3, 0, 0}, x, x), 1, P_E0, 0, 0);
    // The closest point is at a third of the edge, which is rounded.
    expect(vertex_edge({1, 0, 1}, o, {3, 0, 0}), 1, P_E, 1.0 / 3, 0);
}

TEST(VertexVertexDistance, is_the_length_of_the_difference) {
    expect(vertex_vertex({1, 2, 3}, {2, 4, 5}), 9, 0, 0, 0);
    expect(vertex_vertex({1, 2, 3}, {1, 2, 3}), 0, 0, 0, 0);
    expect(vertex_vertex({0, 0, 0}, {-0.0, 0, -0.0}), 0, 0, 0, 0);
}

TEST(Distance, comparison_with_a_sum_of_two_radii_is_exact) {
    const RationalDistance five(vertex_vertex({0, 0, 0}, {3, 4, 0}));
    EXPECT_TRUE(five.within({5, 0, false}));
    EXPECT_FALSE(five.within({5, 0, true}));
    EXPECT_TRUE(five.within({2, 3, false}));
    EXPECT_TRUE(five.within({5, least_float, true}));
    EXPECT_FALSE(five.within({std::nextafter(5, 0), 0, false}));
    EXPECT_TRUE(five.within({std::nextafter(5, 0), 0x1p-50, false}));
    EXPECT_TRUE(five.within({largest_float, largest_float, true}));

    const RationalDistance zero(vertex_vertex({3, 4, 0}, {3, 4, 0}));
    EXPECT_TRUE(zero.within({0, 0, false}));
    EXPECT_FALSE(zero.within({0, 0, true}));
    EXPECT_TRUE(zero.within({0, least_float, true}));

    // The square root of 2 is in no sum of two float64 numbers, but between two of them.
    const RationalDistance root(vertex_vertex({0, 0, 0}, {1, 1, 0}));
    const double below = 0x1.6a09e667f3bccp+0, remainder = 0x1.21165f626cdd5p-53;  // the remainder is rounded down
    EXPECT_FALSE(root.within({below, remainder, false}));
    EXPECT_TRUE(root.within({below, std::nextafter(remainder, 1), true}));
    EXPECT_EQ(root.rounded_down(), below);
}

TEST(Distance, is_right_at_the_limits_of_float64) {
    const RationalDistance widest(vertex_vertex({-largest_float, 0, 0}, {largest_float, 0, 0}));
    EXPECT_EQ(widest.squared(), infinity);
    EXPECT_EQ(widest.rounded_down(), largest_float);
    EXPECT_TRUE(widest.within({largest_float, largest_float, false}));
    EXPECT_FALSE(widest.within({largest_float, largest_float, true}));

    const RationalDistance shortest(vertex_vertex({0, 0, 0}, {least_float, 0, 0}));
    EXPECT_FALSE(shortest.touching());
    EXPECT_EQ(shortest.squared(), 0);
    EXPECT_EQ(shortest.rounded_down(), least_float);
    EXPECT_TRUE(shortest.within({least_float, 0, false}));
    EXPECT_FALSE(shortest.within({least_float, 0, true}));

    // Nearer than any float64 number: the point (1, 0) to the line through (0, 0) and (2^52, 2^-1074).
    const RationalDistance nearer(vertex_edge({1, 0, 0}, {0, 0, 0}, {0x1p52, least_float, 0}));
    EXPECT_FALSE(nearer.touching());
    EXPECT_EQ(nearer.rounded_down(), 0);
    EXPECT_FALSE(nearer.within({0, 0, false}));
    EXPECT_TRUE(nearer.within({0, least_float, true}));
    EXPECT_EQ(nearer.closest(), closest(VertexEdgeType::P_E, 0x1p-52, 0));
}

TEST(Distance, squared_distance_is_rounded_to_nearest_even) {
    // 1 + 2^-53 is the tie between 1 and the next float64 number. Smaller sums round to 1, larger ones to the next
    // number.
    const double half = 0x1p-53;
    const auto squared = [](double y, double z) {
        return RationalDistance(vertex_vertex({0, 0, 0}, {1, y, z})).squared();
    };
    EXPECT_EQ(squared(0x1p-26, 0), 1 + 0x1p-52);
    EXPECT_EQ(squared(std::sqrt(half), 0), std::sqrt(half) * std::sqrt(half) > half ? 1 + 0x1p-52 : 1);
    // y² + z² = 2^-54 + 2^-54 is the tie itself, and 1 is even.
    EXPECT_EQ(squared(0x1p-27, 0x1p-27), 1);
    EXPECT_EQ(squared(std::nextafter(0x1p-27, 1), 0x1p-27), 1 + 0x1p-52);
    EXPECT_EQ(squared(std::nextafter(0x1p-27, 0), 0x1p-27), 1);
    // Sums below 2^1024 - 2^970 round to a finite number, at most largest_float; larger sums and this one round to
    // infinity.
    const auto limit = [](double x, double y, double z) {
        return RationalDistance(vertex_vertex({0, 0, 0}, {x, y, z})).squared();
    };
    EXPECT_EQ(limit(0x1p512, 0, 0), infinity);
    // (2^512 - 2^459)² is slightly more than 2^1024 - 4 · 2^970.
    const double x = std::nextafter(0x1p512, 0);
    EXPECT_EQ(limit(x, 0, 0), std::nextafter(largest_float, 0));
    EXPECT_EQ(limit(x, 0x1p485, 0x1p485), largest_float);
    EXPECT_EQ(limit(x, 0x1.8p485, 0x1p485), infinity);
}

TEST(Distance, squared_distance_can_be_subnormal) {
    EXPECT_EQ(RationalDistance(vertex_vertex({0, 0, 0}, {0x1p-537, 0, 0})).squared(), least_float);
    EXPECT_EQ(RationalDistance(vertex_vertex({0, 0, 0}, {0x1p-538, 0x1p-538, 0})).squared(), 0);  // a tie
    EXPECT_EQ(RationalDistance(vertex_vertex({0, 0, 0}, {0x1p-538, 0x1p-538, least_float})).squared(), least_float);
}

}  // namespace
}  // namespace crumple
