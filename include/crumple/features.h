#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string_view>

namespace crumple {

/// Edge between the vertices a and b: a < b, except for edges that the caller lists, whose vertices stay in the listed
/// order.
struct Edge {
    std::int32_t a, b;
    friend auto operator<=>(const Edge&, const Edge&) = default;
};

/// Kind of a pair of features (docs/motion.md, docs/nearness.md). Features are vertices, edges and faces (triangles).
/// By default, vertices are those that a triangle or an edge names, and edges those of the triangles. The caller may
/// list edges and points to use instead (MeshView::edges, MeshView::points). In a Pair of features, `a` is the index of
/// the feature that the kind names first, `b` of the other one; if points are listed, a vertex's index is its position
/// in the list. Results hold their lists in the order of this enum. The last two kinds are for rods, hair and
/// particles: they cover contacts that pairs of the first two kinds miss.
enum class FeatureKind : std::uint8_t {
    vertex_face,  ///< a: vertex, b: triangle without this vertex
    edge_edge,    ///< a < b: edges without a common vertex
    /// a: vertex, b: edge that belongs to no triangle and does not contain this vertex. Listed only if each edge at the
    /// vertex has a common vertex with b; otherwise the pair of an edge at the vertex and b covers this pair.
    vertex_edge,
    vertex_vertex,  ///< a < b: vertices that belong to no triangle and no edge
};
inline constexpr int feature_kinds = 4;
/// Returns the name of the enumerator, such as "vertex_face".
constexpr std::string_view feature_kind_name(FeatureKind kind) {
    constexpr std::array<std::string_view, feature_kinds> names{"vertex_face", "edge_edge", "vertex_edge",
                                                                "vertex_vertex"};
    return names[static_cast<std::size_t>(kind)];
}

}  // namespace crumple
