#pragma once

// Pairs of features of two triangles, in the order that decides between several closest ones. The distance of two
// triangles that do not intersect is the least distance of these pairs, also for degenerate triangles: two disjoint
// convex polygons are closest at a vertex of one and the other polygon, or at an edge of each.

#include <array>
#include <cstddef>

#include "exact/proximity/static_features.h"

namespace crumple {

using TrianglePoints = std::array<Vec3d, 3>;

/// Number of pairs of features. First come the vertices of the first triangle, with the second as a face, then the
/// vertices of the second, with the first as a face, then edge i of the first, from corner i to the next one, with edge
/// j of the second; j runs faster.
inline constexpr std::size_t triangle_features = 15;

inline Features features_of_triangles(const TrianglePoints& a, const TrianglePoints& b, std::size_t k) {
    if (k < 3) return {FeatureKinds::vertex_face, {a[k], b[0], b[1], b[2]}};
    if (k < 6) return {FeatureKinds::vertex_face, {b[k - 3], a[0], a[1], a[2]}};
    const std::size_t i = (k - 6) / 3, j = (k - 6) % 3;
    return {FeatureKinds::edge_edge, {a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]}};
}

/// True if the points of pair k begin with the second triangle's feature.
inline bool second_comes_first(std::size_t k) { return k >= 3 && k < 6; }

}  // namespace crumple
