#pragma once

// Input of distance queries: two static features, given by their points, and the limit that their distance is compared
// with. Compiled for host and device.

#include <array>
#include <cstddef>
#include <cstdint>

#include "crumple/proximities.h"
#include "geometry/vec.h"

namespace crumple {

enum class FeatureKinds : std::uint8_t { vertex_face, edge_edge, vertex_edge, vertex_vertex };

CRUMPLE_HD constexpr std::size_t points_of(FeatureKinds kinds) {
    return kinds == FeatureKinds::vertex_vertex ? 2 : kinds == FeatureKinds::vertex_edge ? 3 : 4;
}

/// Two features, by their points in this order: p, a, b, c for a vertex p and a face a b c; a, b, c, d for edges a b
/// and c d; p, a, b for a vertex p and an edge a b; p, q for two vertices. Further points are not read. A feature is
/// the closed convex hull of its points, degenerate or not.
struct Features {
    FeatureKinds kinds = FeatureKinds::vertex_vertex;
    std::array<Vec3d, 4> point{};
};

/// Limit on a distance: at most a + b, an exact sum, or below it if `strict`. Both terms are finite and not negative.
struct DistanceLimit {
    double a = 0, b = 0;
    bool strict = false;
};

/// Closest points of two features.
///
/// `type` is a VertexFaceType, an EdgeEdgeType, a VertexEdgeType or a VertexVertexType, where E0, E1 and E2 are the
/// face's edges from a to b, from b to c and from c to a, EA is the edge a b, EB the edge c d, and EA0 the vertex a. It
/// is the first value of the enumeration whose parts are as close to each other as the features are: lowest dimension
/// first, then lowest index. So its parts are as small as possible, and have only one pair of closest points, even if
/// the features have many, as parallel edges do, or are degenerate.
///
/// `at` holds the exact parameters of that pair, rounded to the nearest float64. Vertex and face: (u, v) for the point
/// a + u (b - a) + v (c - a). Two edges: (s, t) for a + s (b - a) and c + t (d - c). Vertex and edge: (t, 0) for a + t
/// (b - a). Two vertices: (0, 0).
struct ClosestPoints {
    std::uint8_t type = 0;
    std::array<double, 2> at{};

    friend bool operator==(const ClosestPoints&, const ClosestPoints&) = default;
};

}  // namespace crumple
