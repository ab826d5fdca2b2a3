#pragma once

// Two features at rest, by their points, and the radii that are asked about: what distances are given. Compiled for
// host and device.

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

/// The points p; a b c of a vertex and a face, a b; c d of two edges, p; a b of a vertex and an edge, p; q of two
/// vertices. What follows them is not read. A feature is the closed convex hull of its points, collapsed or not.
struct Features {
    FeatureKinds kinds = FeatureKinds::vertex_vertex;
    std::array<Vec3d, 4> point{};
};

/// Whether a distance is at most a + b, of which the sum is exact; `strict`: below it. Both are finite and not
/// negative.
struct Reach {
    double a = 0, b = 0;
    bool strict = false;
};

/// Where two features are closest.
///
/// `type` is a VertexFaceType, an EdgeEdgeType, a VertexEdgeType or a VertexVertexType, E0 being the edge from a to b,
/// E1 that from b to c, E2 that from c to a, EA a b, EB c d, and EA0 a. It is the first in that enumeration whose parts
/// are as close to each other as the features are: of lowest dimension, then first by index. So it is never a part
/// where a smaller one would do, and its parts have one pair of closest points, also where the features have many, as
/// parallel edges do, or are collapsed.
///
/// `at` are the parameters of that pair, exact ones rounded to the nearest float64. Vertex and face: (u, v) for the
/// point a + u (b - a) + v (c - a). Two edges: (s, t) for a + s (b - a) and c + t (d - c). Vertex and edge: (t, 0) for
/// a + t (b - a). Two vertices: (0, 0).
struct ClosestPoints {
    std::uint8_t type = 0;
    std::array<double, 2> at{};

    friend bool operator==(const ClosestPoints&, const ClosestPoints&) = default;
};

}  // namespace crumple
