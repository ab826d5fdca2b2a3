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
/// By default, vertices are those that a triangle or an edge names, and edges those of the triangles; the caller may
/// list others (MeshView::edges, MeshView::points). In a Pair of features, `a` is the index of the feature that the
/// kind names first, `b` of the other one; if points are listed, a vertex's index is its position in the list. Results
/// hold their lists in the order of this enum. The last two kinds are for rods, hair and particles: they cover features
/// that are in no pair of the other kinds.
enum class FeatureKind : std::uint8_t {
    vertex_face,    ///< a: vertex, b: triangle without this vertex
    edge_edge,      ///< a < b: edges without a common vertex
    vertex_edge,    ///< a: vertex, b: edge of no triangle, without this vertex. Each edge of the vertex has a common
                    ///< vertex with b
    vertex_vertex,  ///< a < b: vertices of no triangle and no edge
};
inline constexpr int feature_kinds = 4;
/// Returns the name of the enumerator, such as "vertex_face".
constexpr std::string_view feature_kind_name(FeatureKind kind) {
    constexpr std::array<std::string_view, feature_kinds> names{"vertex_face", "edge_edge", "vertex_edge",
                                                                "vertex_vertex"};
    return names[static_cast<std::size_t>(kind)];
}

}  // namespace crumple
