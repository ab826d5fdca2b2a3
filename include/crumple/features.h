#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string_view>

namespace crumple {

/// Two vertices: a < b where triangles have made the edge, else as it is listed.
struct Edge {
    std::int32_t a, b;
    friend auto operator<=>(const Edge&, const Edge&) = default;
};

/// What touches what, or is near it (docs/motion.md, docs/nearness.md). Features are vertices, edges, and faces (the
/// triangles): vertices that a triangle or an edge names and the triangles' edges, or those that the caller lists
/// (MeshView::edges, MeshView::points). In a Pair of features `a` is the first one's index and `b` the second one's;
/// that of a vertex is its place in the list of points, if there is one. The order of the kinds is that of the lists in
/// an answer. The last two are of rods, hair and particles: what no face or edge covers.
enum class FeatureKind : std::uint8_t {
    vertex_face,    ///< a: vertex, b: triangle that does not name it
    edge_edge,      ///< a < b: edges without a common vertex
    vertex_edge,    ///< a: vertex, b: edge of no triangle that does not name it, nor meets all edges of the vertex
    vertex_vertex,  ///< a < b: vertices of no triangle and no edge
};
inline constexpr int feature_kinds = 4;
constexpr std::string_view feature_kind_name(FeatureKind kind) {
    constexpr std::array<std::string_view, feature_kinds> names{"vertex_face", "edge_edge", "vertex_edge",
                                                                "vertex_vertex"};
    return names[static_cast<std::size_t>(kind)];
}

}  // namespace crumple
