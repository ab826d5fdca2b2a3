// Tests of minimum distances on handmade moves with evident results, for each kind of parts of the features (corner,
// side or inside) that come within the distance first.

#include "exact/impact/exact_min_distance.h"

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
constexpr double large = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();

MinDistance within(double distance) { return {.distance = distance, .share = 0}; }
MinDistance share(double share) { return {.distance = 0, .share = share}; }

MovingPoint still(double x, double y, double z) { return {{x, y, z}, {x, y, z}}; }
MovingPoint move(Vec3d start, Vec3d end) { return {start, end}; }

const MovingPoint origin = still(0, 0, 0), right = still(4, 0, 0), up = still(0, 4, 0);

/// Returns the impact of a vertex on the face with corners (0, 0, 0), (4, 0, 0), (0, 4, 0).
Impact to_face(Vec3d start, Vec3d end, const MinDistance& separation) {
    return vertex_face({start, end}, origin, right, up, separation);
}

TEST(VertexFaceMinDistance, vertex_above_the_inside_is_measured_to_the_plane) {
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 1}, within(3)), at(third));
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 1}, within(2)), at(two_thirds));
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 1}, within(1)), at(1));
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 1}, within(1 - 0x1p-53)), none);
    EXPECT_EQ(to_face({1, 1, -4}, {1, 1, -1}, within(3)), at(third));
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, -4}, within(0)), at(0.5));
    // Passes through the plane and ends farther away.
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, -28}, within(2)), at(0.0625));
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 1}, within(4)), at_start);
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 5}, within(4)), at_start);
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 5}, within(4 - 0x1p-51)), none);
}

TEST(VertexFaceMinDistance, vertex_beside_the_face_is_measured_to_sides_and_corners) {
    EXPECT_EQ(to_face({1, -3, 8}, {1, -3, 0}, within(5)), at(0.5));      // 3² + 4² = 5²
    EXPECT_EQ(to_face({4, 4, 4}, {4, 4, -5}, within(3)), at(third));     // 8 + 1 = 3²
    EXPECT_EQ(to_face({-1, -2, 8}, {-1, -2, -4}, within(3)), at(0.5));   // 1 + 4 + 4 = 3²
    EXPECT_EQ(to_face({6, -1, 8}, {6, -1, -10}, within(3)), at(third));  // 4 + 1 + 4 = 3²
    EXPECT_EQ(to_face({1, -3, 8}, {1, -3, 0}, within(3)), at(1));
    EXPECT_EQ(to_face({1, -3, 8}, {1, -3, 0}, within(3 - 0x1p-51)), none);
    EXPECT_EQ(to_face({-1, -2, 8}, {-1, -2, -4}, within(2)), none);
}

TEST(VertexFaceMinDistance, parallel_motion_at_exactly_the_min_distance_counts) {
    // The vertex moves so that its distance to the plane of the face, or to the line of a side, always equals the
    // minimum distance.
    EXPECT_EQ(to_face({-2, 1, 3}, {4, 1, 3}, within(3)), at(third));
    EXPECT_EQ(to_face({-2, -2, 3}, {4, 4, 3}, within(3)), at(third));
    EXPECT_EQ(to_face({3, 3, 3}, {1, 1, 3}, within(3)), at(0.5));
    EXPECT_EQ(to_face({-1, -9, 3}, {-1, 9, 3}, within(3)), none);
    EXPECT_EQ(to_face({1, 1, 3}, {9, 1, 3}, within(3)), at_start);
    EXPECT_EQ(to_face({-2, -4, 3}, {4, -4, 3}, within(5)), at(third));
    EXPECT_EQ(to_face({-4, 0, 3}, {-4, 4, 3}, within(5)), at_start);
}

TEST(VertexFaceMinDistance, min_distance_reached_for_an_instant_counts) {
    // For x = 2 t - 1 the plane is z = -x y, and the distance (3 + 4 x^2) / sqrt(1 + x^2) is 3 at least, at x = 0.
    const MovingPoint p = move({0, -4, 3}, {0, 4, 3});
    const MovingPoint a = move({-99, -9, -9}, {-99, -9, 9}), b = move({99, -9, -9}, {99, -9, 9});
    const MovingPoint c = move({0, 9, 9}, {0, 9, -9});
    EXPECT_EQ(vertex_face(p, a, b, c, within(3)), at(0.5));
    EXPECT_EQ(vertex_face(p, a, b, c, within(3 - 0x1p-51)), none);
    // Two roots, some 2^-27 to the left and to the right.
    const Impact early = vertex_face(p, a, b, c, within(3 + 0x1p-51));
    EXPECT_LT(early.toi, 0.5 - 0x1p-28);
    EXPECT_GT(early.toi, 0.5 - 0x1p-27);
    EXPECT_EQ(to_face({-3, -3, 4}, {3, -3, 4}, within(5)), at(0.5));  // from t = 1/2 on, a side is at this distance
    EXPECT_EQ(to_face({-7, -1, 0}, {1, -7, 0}, within(5)), at(0.5));  // passes a corner at (-3, -4, 0)
    EXPECT_EQ(to_face({-7, -1, 0}, {1, -7, 0}, within(5 - 0x1p-50)), none);
}

TEST(VertexFaceMinDistance, collapsed_faces_are_measured_like_edges_or_points) {
    const auto face = [](Vec3d start, Vec3d end, const MovingPoint& b, const MovingPoint& c, double distance) {
        return vertex_face({start, end}, origin, b, c, within(distance));
    };
    EXPECT_EQ(face({1, 0, 4}, {1, 0, 1}, right, right, 3), at(third));
    EXPECT_EQ(face({3, 0, 4}, {3, 0, 1}, still(2, 0, 0), right, 3), at(third));
    EXPECT_EQ(face({8, 0, 4}, {8, 0, 1}, right, still(2, 0, 0), 5), at(third));
    EXPECT_EQ(face({0, 0, 4}, {0, 0, 1}, origin, origin, 3), at(third));
    // The face collapses at t = 1/2, when its plane is upright; the vertex is near that plane, but not near the face.
    const MovingPoint c = move({1, 2, 1}, {1, -2, -1}), far = still(9, 0, 0);
    EXPECT_EQ(vertex_face(far, origin, right, c, within(4)), none);
    EXPECT_EQ(vertex_face(far, origin, right, c, within(5)), at_start);
    EXPECT_EQ(vertex_face(far, origin, right, move({6, 2, 0}, {6, -2, 0}), within(3)), at(0.5));
}

TEST(EdgeEdgeMinDistance, crossing_edges_reach_the_min_distance_at_the_exact_time) {
    const auto fall = [](double x, double from, double to, double distance) {
        return edge_edge(origin, right, move({x, -2, from}, {x, -2, to}), move({x, 2, from}, {x, 2, to}),
                         within(distance));
    };
    EXPECT_EQ(fall(1, 4, 1, 3), at(third));
    EXPECT_EQ(fall(1, 4, -4, 0), at(0.5));
    EXPECT_EQ(fall(4, -4, -1, 3), at(third));
    EXPECT_EQ(fall(8, 6, -3, 5), at(third));  // 4 beyond an end, at height 3
    EXPECT_EQ(fall(8, 6, -3, 4), at(two_thirds));
    EXPECT_EQ(fall(8, 6, -3, 4 - 0x1p-50), none);
    EXPECT_EQ(fall(1, 4, 5, 4), at_start);
    // The edges are in two parallel planes, at the minimum distance from each other at all times.
    EXPECT_EQ(edge_edge(origin, right, move({-2, -2, 3}, {4, -2, 3}), move({-2, 2, 3}, {4, 2, 3}), within(3)),
              at(third));
    EXPECT_EQ(edge_edge(origin, right, move({-2, 1, 3}, {4, 1, 3}), move({-2, 2, 3}, {4, 2, 3}), within(3)), none);
    // The minimum distance is reached at t = 1/2 only, as in min_distance_reached_for_an_instant_counts.
    const MovingPoint a = move({-9, -4, 3}, {-9, 4, 3}), b = move({9, -4, 3}, {9, 4, 3});
    const MovingPoint c = move({0, -9, -9}, {0, -9, 9}), d = move({0, 9, 9}, {0, 9, -9});
    EXPECT_EQ(edge_edge(a, b, c, d, within(3)), at(0.5));
    EXPECT_EQ(edge_edge(a, b, c, d, within(3 - 0x1p-51)), none);
}

TEST(EdgeEdgeMinDistance, parallel_and_collapsed_edges_reach_the_min_distance_at_the_exact_time) {
    const auto edge = [](Vec3d c, Vec3d d, Vec3d by, double distance) {
        return edge_edge(origin, right, move(c, c + by), move(d, d + by), within(distance));
    };
    EXPECT_EQ(edge({1, 0, 4}, {3, 0, 4}, {0, 0, -3}, 3), at(third));
    EXPECT_EQ(edge({-1, 0, 4}, {9, 0, 4}, {0, 0, -3}, 3), at(third));
    EXPECT_EQ(edge({8, 0, 6}, {9, 0, 6}, {0, 0, -9}, 5), at(third));
    EXPECT_EQ(edge({9, 0, 0}, {12, 0, 0}, {-6, 0, 0}, 3), at(third));  // on one line
    EXPECT_EQ(edge({9, 3, 0}, {12, 3, 0}, {-15, 0, 0}, 3), at(third));
    EXPECT_EQ(edge({1, 0, 4}, {1, 0, 4}, {0, 0, -3}, 3), at(third));
    EXPECT_EQ(edge_edge(origin, origin, move({-3, 4, 0}, {3, 4, 0}), move({-3, 4, 0}, {3, 4, 0}), within(4)), at(0.5));
    // Parallel at t = 1/2 only, at the offset (0, 4, 3).
    EXPECT_EQ(edge_edge(still(-9, 0, 0), still(9, 0, 0), move({-9, 8, 3}, {-9, 0, 3}), move({9, 12, 3}, {9, -4, 3}),
                        within(5)),
              at(0.5));
}

TEST(VertexEdgeMinDistance, vertex_is_measured_to_the_line_or_the_nearer_end) {
    const auto edge = [](Vec3d start, Vec3d end, double distance) {
        return vertex_edge({start, end}, origin, right, within(distance));
    };
    EXPECT_EQ(edge({1, 0, 4}, {1, 0, 1}, 3), at(third));
    EXPECT_EQ(edge({1, 3, 8}, {1, 3, 0}, 5), at(0.5));
    EXPECT_EQ(edge({-3, 0, 8}, {-3, 0, 0}, 5), at(0.5));
    EXPECT_EQ(edge({7, 0, 8}, {7, 0, 0}, 5), at(0.5));
    EXPECT_EQ(edge({1, -4, 3}, {1, 4, 3}, 3), at(0.5));
    EXPECT_EQ(edge({1, -4, 3}, {1, 4, 3}, 3 - 0x1p-51), none);
    EXPECT_EQ(edge({-2, 3, 0}, {4, 3, 0}, 3), at(third));  // parallel to the edge
    EXPECT_EQ(edge({9, 0, 0}, {3, 0, 0}, 3), at(third));   // on the edge's line
    EXPECT_EQ(vertex_edge(move({0, 0, 4}, {0, 0, 1}), origin, origin, within(3)), at(third));
}

TEST(VertexVertexMinDistance, two_vertices_reach_the_min_distance_at_the_exact_time) {
    EXPECT_EQ(vertex_vertex(move({4, 0, 0}, {1, 0, 0}), origin, within(3)), at(third));
    EXPECT_EQ(vertex_vertex(move({-4, 3, 0}, {4, 3, 0}), origin, within(3)), at(0.5));
    EXPECT_EQ(vertex_vertex(move({-4, 3, 0}, {4, 3, 0}), origin, within(3 - 0x1p-51)), none);
    EXPECT_EQ(vertex_vertex(move({-4, 3, 0}, {4, 3, 0}), origin, within(5)), at_start);
    EXPECT_EQ(vertex_vertex(move({-8, 3, 0}, {4, 3, 0}), origin, within(5)), at(third));
    EXPECT_EQ(vertex_vertex(move({1, 2, 3}, {4, 5, 6}), move({1, 2, 5}, {4, 5, 8}), within(2)), at_start);
    EXPECT_EQ(vertex_vertex(move({1, 2, 3}, {4, 5, 6}), move({1, 2, 5}, {4, 5, 8}), within(1)), none);
}

TEST(MinDistanceShare, share_refers_to_the_initial_distance_of_each_pair) {
    EXPECT_EQ(vertex_vertex(move({8, 0, 0}, {0, 0, 0}), origin, share(0.5)), at(0.5));
    EXPECT_EQ(vertex_vertex(move({8, 0, 0}, {0, 0, 0}), origin, share(0.25)), at(0.75));
    EXPECT_EQ(vertex_vertex(move({8, 0, 0}, {0, 0, 0}), origin, share(0.9)), at(1 - 0.9));
    EXPECT_EQ(vertex_vertex(move({1, 1, 1}, {0, 0, 0}), origin, share(0.7)), at(1 - 0.7));  // initially √3 apart
    EXPECT_EQ(vertex_vertex(move({1, 1, 1}, {0, 0, 0}), origin, share(1 - 0x1p-53)), at(0x1p-53));
    EXPECT_EQ(vertex_vertex(move({1, 1, 1}, {2, 1, 1}), origin, share(1 - 0x1p-53)), none);
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, -4}, share(0.5)), at(0.25));
    EXPECT_EQ(to_face({1, -3, 4}, {1, 0, 0}, share(0.25)), at(0.75));
    EXPECT_EQ(edge_edge(origin, right, move({1, -2, 4}, {1, -2, 1}), move({2, 2, 4}, {2, 2, 1}), share(0.75)),
              at(third));
    EXPECT_EQ(vertex_edge(move({6, 0, 7}, {4, 0, 0}), origin, right, share(0.3)), at(1 - 0.3));
}

TEST(MinDistanceShare, touching_features_are_reported_at_the_start) {
    EXPECT_EQ(to_face({1, 1, 0}, {1, 1, 4}, share(0.5)), at_start);
    EXPECT_EQ(to_face({1, 1, 0}, {1, 1, 4}, share(0)), at_start);
    EXPECT_EQ(vertex_vertex(origin, origin, share(0.5)), at_start);
}

TEST(MinDistanceShare, larger_of_distance_and_share_counts) {
    const auto both = [](double distance, double share) {
        return vertex_vertex(move({8, 0, 0}, {0, 0, 0}), origin, {.distance = distance, .share = share});
    };
    EXPECT_EQ(both(6, 0.5), at(0.25));
    EXPECT_EQ(both(2, 0.5), at(0.5));
    EXPECT_EQ(both(4, 0.5), at(0.5));
    EXPECT_EQ(both(8, 0.5), at_start);
}

TEST(RationalMinDistance, is_right_at_the_limits_of_float64) {
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 1}, within(large)), at_start);
    EXPECT_EQ(to_face({1, 1, 4}, {1, 1, 0}, within(least)), at(1 - 0x1p-53));
    EXPECT_EQ(vertex_vertex(move({large, 0, 0}, {-large, 0, 0}), still(-large, 0, 0), within(large)), at(0.5));
    EXPECT_EQ(vertex_vertex(move({4 * least, 0, 0}, {least, 0, 0}), origin, within(3 * least)), at(third));
    EXPECT_EQ(vertex_vertex(move({large, 0, 0}, {-large, 0, 0}), still(-large, 0, 0), share(0.5)), at(0.5));
    // The time is above 0, but rounds down to 0.
    EXPECT_EQ(vertex_vertex(move({1, 0, 0}, {-large, 0, 0}), origin, within(1 - 0x1p-53)), at(0));
    EXPECT_EQ(vertex_face(move({0, 0, 1e300}, {0, 0, 1e-300}), still(-1e300, -1e300, 0), still(1e300, -1e300, 0),
                          still(0, 1e300, 0), within(1e-300)),
              at(1));
    EXPECT_EQ(vertex_face(move({0, 0, 1e300}, {0, 0, 1e-300}), still(-1e300, -1e300, 0), still(1e300, -1e300, 0),
                          still(0, 1e300, 0), within(0.5e-300)),
              none);
}

}  // namespace
}  // namespace crumple
