// Tests on handmade moves with evident results, for every way in which features can be degenerate.

#include "exact/impact/exact_impact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "impacts/moves.h"

namespace crumple {
namespace {

constexpr Impact none{};
constexpr Impact at_start{true, 0, true};
constexpr Impact at(double toi) { return {true, toi, false}; }
/// One third and two thirds rounded down: 1.0 / 3 and 2.0 / 3 are below the exact values.
constexpr double third = 1.0 / 3, two_thirds = 2.0 / 3;

MovingPoint still(double x, double y, double z) { return {{x, y, z}, {x, y, z}}; }
MovingPoint move(Vec3d start, Vec3d end) { return {start, end}; }

const MovingPoint origin = still(0, 0, 0), right = still(4, 0, 0), up = still(0, 4, 0);

/// Returns the impact of a vertex on the face with corners (0, 0, 0), (4, 0, 0), (0, 4, 0).
Impact onto_face(Vec3d start, Vec3d end) { return vertex_face({start, end}, origin, right, up); }

TEST(VertexFaceImpact, vertex_meets_the_inside_at_the_exact_time) {
    EXPECT_EQ(onto_face({1, 1, 1}, {1, 1, -2}), at(third));
    EXPECT_EQ(onto_face({1, 1, 2}, {1, 1, -1}), at(two_thirds));
    EXPECT_EQ(onto_face({1, 1, 1}, {1, 1, -1}), at(0.5));
    EXPECT_EQ(onto_face({1, 1, 1}, {1, 1, 0}), at(1));
    EXPECT_EQ(onto_face({1, 1, 0}, {1, 1, 1}), at_start);
    EXPECT_EQ(onto_face({1, 1, 2}, {1, 1, 1}), none);
    EXPECT_EQ(onto_face({1, 1, 1}, {1, 1, std::numeric_limits<double>::denorm_min()}), none);
}

TEST(VertexFaceImpact, border_belongs_to_the_face) {
    EXPECT_EQ(onto_face({2, 2, 1}, {2, 2, -1}), at(0.5));
    EXPECT_EQ(onto_face({0, 0, 1}, {0, 0, -2}), at(third));
    EXPECT_EQ(onto_face({2, 2 + 0x1p-51, 1}, {2, 2 + 0x1p-51, -1}), none);
    EXPECT_EQ(onto_face({2, 2 - 0x1p-52, 1}, {2, 2 - 0x1p-52, -1}), at(0.5));
    EXPECT_EQ(onto_face({-0x1p-1074, 1, 1}, {-0x1p-1074, 1, -1}), none);
    EXPECT_EQ(onto_face({-1, -1, 1}, {1, 1, -1}), at(0.5));  // through a corner
}

TEST(VertexFaceImpact, second_root_counts_if_the_first_is_outside_the_face) {
    // The face turns about the x axis: at y = 4 - 4 t, where the vertex is, its plane is at the height 16 t (1 - t).
    const MovingPoint a = still(-9, 0, 0), b = still(9, 0, 0);
    const MovingPoint rising = move({0, 4, 0}, {0, 4, 16});
    EXPECT_EQ(vertex_face(move({0, 4, 3}, {0, 0, 3}), a, b, rising), at(0.25));
    EXPECT_EQ(vertex_face(move({8, 4, 3}, {0, 0, 3}), a, b, rising), at(0.75));
}

TEST(VertexFaceImpact, contact_at_a_double_root_counts) {
    // The face of the previous test, whose plane reaches the height 4 at t = 1/2 only.
    const MovingPoint a = still(-9, 0, 0), b = still(9, 0, 0), rising = move({0, 4, 0}, {0, 4, 16});
    EXPECT_EQ(vertex_face(move({0, 4, 4}, {0, 0, 4}), a, b, rising), at(0.5));
    EXPECT_EQ(vertex_face(move({0, 4, 4 + 0x1p-50}, {0, 0, 4 + 0x1p-50}), a, b, rising), none);
    EXPECT_EQ(vertex_face(move({9, 4, 4}, {9, 0, 4}), a, b, rising), none);
    // At y = 4 - 6 t the height is 6 t (2 - 3 t), at most 2, at 1/3.
    const MovingPoint steep = move({0, 4, 0}, {0, 4, 12});
    EXPECT_EQ(vertex_face(move({0, 4, 2}, {0, -2, 2}), a, b, steep), at(third));
}

TEST(VertexFaceImpact, contact_at_a_triple_root_counts) {
    // Four points move towards the origin and pass through it at 1/3: their determinant (volume) is a cube in t.
    const auto through = [](double x, double y, double z) { return move({x, y, z}, {-2 * x, -2 * y, -2 * z}); };
    EXPECT_EQ(vertex_face(through(0, 0, 1), through(1, 0, 0), through(0, 1, 0), through(-1, -1, 0)), at(third));
    // Only the face collapses to the origin at 1/3; the vertex is outside the face's plane, or at the origin.
    const MovingPoint a = through(1, 0, 0), b = through(0, 1, 0), c = through(-1, -1, 0);
    EXPECT_EQ(vertex_face(still(0, 0, 1), a, b, c), none);
    EXPECT_EQ(vertex_face(still(0, 0, 0), a, b, c), at_start);
    EXPECT_EQ(vertex_face(move({0, 0, 1}, {0, 0, -2}), a, b, c), at(third));
}

TEST(VertexFaceImpact, vertex_meets_a_face_that_collapses_at_contact) {
    // The face shrinks to the segment from 0 to 4 on the x axis, at 1/2, and grows again on the other side.
    const MovingPoint c = move({1, 2, 0}, {1, -2, 0});
    EXPECT_EQ(vertex_face(move({2, 0, 1}, {2, 0, -1}), origin, right, c), at(0.5));
    EXPECT_EQ(vertex_face(move({5, 0, 1}, {5, 0, -1}), origin, right, c), none);
    EXPECT_EQ(vertex_face(move({4, 0, 1}, {4, 0, -1}), origin, right, c), at(0.5));
    // A corner beyond the others makes the segment longer.
    EXPECT_EQ(vertex_face(move({5, 0, 1}, {5, 0, -1}), origin, right, move({6, 2, 0}, {6, -2, 0})), at(0.5));
}

TEST(VertexFaceImpact, vertex_moving_in_the_plane_of_the_face_can_meet_it) {
    // All in z = 0 at all times: the vertex enters through a side, a corner, or was inside.
    EXPECT_EQ(onto_face({-1, 1, 0}, {2, 1, 0}), at(third));
    EXPECT_EQ(onto_face({3, 3, 0}, {1, 1, 0}), at(0.5));
    EXPECT_EQ(onto_face({-1, -1, 0}, {1, 1, 0}), at(0.5));
    EXPECT_EQ(onto_face({-1, 1, 0}, {1, -1, 0}), at(0.5));  // grazes a corner
    EXPECT_EQ(onto_face({-2, 1, 0}, {1, -1, 0}), none);
    EXPECT_EQ(onto_face({1, 1, 0}, {9, 9, 0}), at_start);
    EXPECT_EQ(onto_face({-1, 0, 0}, {2, 0, 0}), at(third));  // along the line of a side
    EXPECT_EQ(onto_face({-2, 0, 0}, {-1, 0, 0}), none);
    EXPECT_EQ(onto_face({-1, 0, 0}, {0, 0, 0}), at(1));
    // The face sweeps over the vertex, in a slanted plane.
    const auto in_plane = [](double x, double y) { return Vec3d{x, y, x + 2 * y}; };
    EXPECT_EQ(vertex_face(move(in_plane(0, 0), in_plane(0, 0)), move(in_plane(1, -8), in_plane(-2, -8)),
                          move(in_plane(9, 0), in_plane(6, 0)), move(in_plane(1, 8), in_plane(-2, 8))),
              at(third));
    // In a plane that itself turns: z = x (1 - 2 t).
    const MovingPoint lower = move({4, 0, 4}, {4, 0, -4}), upper = move({4, 4, 4}, {4, 4, -4});
    EXPECT_EQ(vertex_face(move({3, -1, 3}, {3, 2, -3}), origin, lower, upper), at(third));
    EXPECT_EQ(vertex_face(move({5, -1, 5}, {5, 2, -5}), origin, lower, upper), none);
}

TEST(VertexFaceImpact, collapsed_faces_act_like_edges_or_points) {
    // A segment.
    EXPECT_EQ(vertex_face(move({1, 0, 1}, {1, 0, -2}), origin, right, right), at(third));
    EXPECT_EQ(vertex_face(move({1, 0, 1}, {1, 0, -2}), origin, still(2, 0, 0), right), at(third));
    EXPECT_EQ(vertex_face(move({3, 0, 1}, {3, 0, -2}), origin, right, still(2, 0, 0)), at(third));
    EXPECT_EQ(vertex_face(move({5, 0, 1}, {5, 0, -2}), origin, right, still(2, 0, 0)), none);
    EXPECT_EQ(vertex_face(move({1, 1, 1}, {1, 1, -2}), origin, right, right), none);
    // A point.
    EXPECT_EQ(vertex_face(move({0, 0, 1}, {0, 0, -2}), origin, origin, origin), at(third));
    EXPECT_EQ(vertex_face(move({0, 1, 1}, {0, 0, -2}), origin, origin, origin), none);
    EXPECT_EQ(vertex_face(origin, origin, origin, origin), at_start);
}

TEST(VertexFaceImpact, static_features_meet_only_if_they_touch) {
    EXPECT_EQ(onto_face({1, 1, 0}, {1, 1, 0}), at_start);
    EXPECT_EQ(onto_face({2, 2, 0}, {2, 2, 0}), at_start);
    EXPECT_EQ(onto_face({3, 2, 0}, {3, 2, 0}), none);
    EXPECT_EQ(onto_face({1, 1, 1}, {1, 1, 1}), none);
}

TEST(VertexFaceImpact, irrational_time_is_rounded_down) {
    // The face of contact_at_a_double_root_counts: its height 16 t (1 - t) is 2 at t = (1 - sqrt(1/2)) / 2.
    const MovingPoint a = still(-9, 0, 0), b = still(9, 0, 0), rising = move({0, 4, 0}, {0, 4, 16});
    const Impact found = vertex_face(move({0, 4, 2}, {0, 0, 2}), a, b, rising);
    EXPECT_TRUE(found.meets);
    EXPECT_FALSE(found.start);
    EXPECT_NEAR(found.toi, (1 - std::sqrt(0.5)) / 2, 1e-15);
    // 0.14644660940672623779957781894757...: the largest float64 below.
    EXPECT_EQ(found.toi, 0x1.2bec333018866p-3);
}

TEST(EdgeEdgeImpact, crossing_edges_meet_at_the_exact_time) {
    const MovingPoint left = still(-1, 0, 0), east = still(1, 0, 0);
    EXPECT_EQ(edge_edge(left, east, move({0, -1, 1}, {0, -1, -2}), move({0, 1, 1}, {0, 1, -2})), at(third));
    EXPECT_EQ(edge_edge(left, east, move({1, -1, 1}, {1, -1, -1}), move({1, 1, 1}, {1, 1, -1})), at(0.5));
    EXPECT_EQ(edge_edge(left, east, move({2, -1, 1}, {2, -1, -1}), move({2, 1, 1}, {2, 1, -1})), none);
    EXPECT_EQ(edge_edge(left, east, move({0, -1, 0}, {0, -1, 1}), move({0, 1, 0}, {0, 1, 1})), at_start);
    EXPECT_EQ(edge_edge(left, east, move({0, -1, 1}, {0, -1, 0}), move({0, 1, 1}, {0, 1, 0})), at(1));
    EXPECT_EQ(edge_edge(left, east, move({0, 0, 1}, {0, 0, -1}), move({0, 1, 1}, {0, 1, -1})), at(0.5));
}

TEST(EdgeEdgeImpact, parallel_edges_meet_where_they_overlap) {
    const MovingPoint left = still(-1, 0, 0), east = still(1, 0, 0);
    // They stay parallel, so the determinant of the four points is 0 at all times.
    EXPECT_EQ(edge_edge(left, east, move({0, 0, 1}, {0, 0, -2}), move({5, 0, 1}, {5, 0, -2})), at(third));
    EXPECT_EQ(edge_edge(left, east, move({-5, 0, 1}, {-5, 0, -2}), move({5, 0, 1}, {5, 0, -2})), at(third));
    EXPECT_EQ(edge_edge(left, east, move({1, 0, 1}, {1, 0, -2}), move({5, 0, 1}, {5, 0, -2})), at(third));
    EXPECT_EQ(edge_edge(left, east, move({2, 0, 1}, {2, 0, -2}), move({5, 0, 1}, {5, 0, -2})), none);
    // They are parallel at the time of contact only, 1/2: overlapping, the one within the other, the same, apart.
    const auto through = [&](double c, double d) {
        return edge_edge(left, east, move({c, 1, 1}, {c, -1, -1}), move({d, -1, 1}, {d, 1, -1}));
    };
    EXPECT_EQ(through(-3, 0), at(0.5));
    EXPECT_EQ(through(0, -3), at(0.5));
    EXPECT_EQ(through(0, 3), at(0.5));
    EXPECT_EQ(through(-3, 3), at(0.5));
    EXPECT_EQ(through(0.5, -0.5), at(0.5));
    EXPECT_EQ(through(1, -1), at(0.5));
    EXPECT_EQ(through(1, 2), at(0.5));
    EXPECT_EQ(through(-3, -2), none);
    EXPECT_EQ(through(3, 2), none);
}

TEST(EdgeEdgeImpact, edges_moving_in_one_plane_can_meet) {
    const MovingPoint left = still(-1, 0, 0), east = still(1, 0, 0);
    EXPECT_EQ(edge_edge(left, east, move({0, 1, 0}, {0, -2, 0}), move({3, 2, 0}, {3, -1, 0})), at(third));
    EXPECT_EQ(edge_edge(left, east, move({0, 1, 0}, {0, 2, 0}), move({4, -2, 0}, {4, 2, 0})), none);
    EXPECT_EQ(edge_edge(left, east, move({0, 1, 0}, {5, 1, 0}), move({0, -1, 0}, {5, -1, 0})), at_start);
    // The moving edge hits an end of the static one, from the side and along its line.
    EXPECT_EQ(edge_edge(left, east, move({2, -1, 0}, {-1, -1, 0}), move({2, 1, 0}, {-1, 1, 0})), at(third));
    EXPECT_EQ(edge_edge(left, east, move({2, 0, 0}, {-1, 0, 0}), move({3, 0, 0}, {0, 0, 0})), at(third));
    EXPECT_EQ(edge_edge(left, east, move({3, 0, 0}, {2, 0, 0}), move({4, 0, 0}, {3, 0, 0})), none);
}

TEST(EdgeEdgeImpact, collapsed_edges_act_like_points) {
    const MovingPoint left = still(-1, 0, 0), east = still(1, 0, 0);
    const MovingPoint falling = move({0, 0, 1}, {0, 0, -2}), beside = move({2, 0, 1}, {2, 0, -2});
    EXPECT_EQ(edge_edge(left, east, falling, falling), at(third));
    EXPECT_EQ(edge_edge(left, east, beside, beside), none);
    EXPECT_EQ(edge_edge(origin, origin, falling, falling), at(third));
    EXPECT_EQ(edge_edge(origin, origin, left, east), at_start);
    // An edge that is a point at the time of contact only.
    EXPECT_EQ(edge_edge(left, east, move({-1, 1, 1}, {1, -1, -1}), move({1, -1, 1}, {-1, 1, -1})), at(0.5));
    EXPECT_EQ(edge_edge(left, east, move({1, 1, 1}, {3, -1, -1}), move({3, -1, 1}, {1, 1, -1})), none);
}

TEST(EdgeEdgeImpact, static_edge_that_pierces_a_face_has_no_impact_with_it) {
    // An edge through the middle of a face touches none of its sides, and the ends of the edge do not touch the face.
    const MovingPoint below = still(1, 1, -1), above = still(1, 1, 1);
    EXPECT_EQ(edge_edge(below, above, origin, right), none);
    EXPECT_EQ(edge_edge(below, above, right, up), none);
    EXPECT_EQ(edge_edge(below, above, up, origin), none);
    EXPECT_EQ(vertex_face(below, origin, right, up), none);
    EXPECT_EQ(vertex_face(above, origin, right, up), none);
}

TEST(VertexEdgeImpact, vertex_meets_inside_and_ends_at_the_exact_time) {
    EXPECT_EQ(vertex_edge(move({1, 1, 1}, {1, -2, -2}), origin, right), at(third));
    EXPECT_EQ(vertex_edge(move({0, 1, 1}, {0, -2, -2}), origin, right), at(third));
    EXPECT_EQ(vertex_edge(move({5, 1, 1}, {5, -2, -2}), origin, right), none);
    EXPECT_EQ(vertex_edge(move({1, 1, 1}, {1, -2, -1}), origin, right), none);  // past it
    EXPECT_EQ(vertex_edge(still(1, 0, 0), origin, right), at_start);
    EXPECT_EQ(vertex_edge(move({1, 1, 0}, {1, 0, 0}), origin, right), at(1));
    // The vertex moves along the line of the edge, which moves, too.
    EXPECT_EQ(vertex_edge(move({-1, 0, 0}, {2, 0, 3}), move({0, 0, 0}, {0, 0, 3}), move({4, 0, 0}, {4, 0, 3})),
              at(third));
    EXPECT_EQ(vertex_edge(move({-2, 0, 0}, {-1, 0, 0}), origin, right), none);
    // Where the edge collapses to a point at 1/2.
    EXPECT_EQ(vertex_edge(move({0, 0, 1}, {0, 0, -1}), move({-1, 0, 0}, {1, 0, 0}), move({1, 0, 0}, {-1, 0, 0})),
              at(0.5));
    EXPECT_EQ(vertex_edge(still(0.5, 0, 0), move({1, 0, 0}, {-1, 0, 0}), move({2, 0, 0}, {-2, 0, 0})), at(0.25));
    EXPECT_EQ(vertex_edge(move({1, 0, 1}, {1, 0, -1}), move({-1, 0, 0}, {1, 0, 0}), move({1, 0, 0}, {-1, 0, 0})), none);
    EXPECT_EQ(vertex_edge(move({0, 0, 1}, {0, 0, -2}), origin, origin), at(third));
}

TEST(VertexVertexImpact, vertices_meet_when_all_coordinates_are_equal) {
    EXPECT_EQ(vertex_vertex(move({1, 2, 3}, {-2, -4, -6}), origin), at(third));
    EXPECT_EQ(vertex_vertex(move({1, 2, 3}, {-2, -4, -5}), origin), none);
    EXPECT_EQ(vertex_vertex(move({1, 0, 0}, {-1, 0, 0}), move({-1, 0, 0}, {1, 0, 0})), at(0.5));
    EXPECT_EQ(vertex_vertex(move({1, 5, 2}, {0, 5, 2}), still(0, 5, 2)), at(1));
    EXPECT_EQ(vertex_vertex(move({1, 5, 2}, {7, 0, 3}), move({1, 5, 2}, {0, 5, 2})), at_start);
    EXPECT_EQ(vertex_vertex(move({1, 5, 2}, {7, 0, 3}), move({1, 5, 2}, {7, 0, 3})), at_start);
    EXPECT_EQ(vertex_vertex(right, up), none);
    EXPECT_EQ(vertex_vertex(still(0.0, 1, 2), still(-0.0, 1, 2)), at_start);
}

TEST(RationalImpact, is_right_at_the_limits_of_float64) {
    constexpr double large = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
    // From -max to max, which is further than any float64 number.
    EXPECT_EQ(vertex_face(move({0, 0, large}, {0, 0, -large}), still(-large, -large, 0), still(large, -large, 0),
                          still(0, large, 0)),
              at(0.5));
    // In units of the least subnormal number.
    EXPECT_EQ(vertex_face(move({least, least, least}, {least, least, -2 * least}), origin, still(4 * least, 0, 0),
                          still(0, 4 * least, 0)),
              at(third));
    // Both: the vertex moves from 2^-1074 to -max. The time at which it crosses 0 is positive, but rounds down to 0.
    const Impact tiny =
        vertex_face(move({0, 0, least}, {0, 0, -large}), still(-1, -1, 0), still(1, -1, 0), still(0, 1, 0));
    EXPECT_EQ(tiny, at(0));
    EXPECT_EQ(vertex_vertex(move({1, 0, 0}, {-0x1p1023, 0, 0}), origin).toi, 0x1p-1023 - least);
    // Just before the end.
    EXPECT_EQ(vertex_vertex(move({large, 0, 0}, {-least, 0, 0}), origin), at(1 - 0x1p-53));
    // The vertex ends above the plane by the least number; the other coordinates are huge.
    EXPECT_EQ(vertex_face(move({0, 0, 1e300}, {0, 0, least}), still(-1e300, -1e300, 0), still(1e300, -1e300, 0),
                          still(0, 1e300, 0)),
              none);
    EXPECT_EQ(
        edge_edge(still(-1e300, 0, 0), still(1e300, 0, 0), move({1e-300, -1e-300, 1e300}, {1e-300, -1e-300, -1e300}),
                  move({1e-300, 1e-300, 1e300}, {1e-300, 1e-300, -1e300})),
        at(0.5));
}

}  // namespace
}  // namespace crumple
