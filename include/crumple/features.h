#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string_view>

namespace crumple {

/// Two vertices, a < b.
struct Edge {
    std::int32_t a, b;
    friend auto operator<=>(const Edge&, const Edge&) = default;
};

/// What touches what, or is near it (docs/motion.md, docs/nearness.md). Features are vertices that a triangle names,
/// edges, and faces (the triangles). In a Pair of features `a` is the first one's index and `b` the second one's.
/// The order of the kinds is that of the lists in an answer.
enum class FeatureKind : std::uint8_t {
    vertex_face,  ///< a: vertex, b: triangle that does not name it
    edge_edge,    ///< a < b: edges without a common vertex
};
inline constexpr int feature_kinds = 2;
constexpr std::string_view feature_kind_name(FeatureKind kind) {
    constexpr std::array<std::string_view, feature_kinds> names{"vertex_face", "edge_edge"};
    return names[static_cast<std::size_t>(kind)];
}

}  // namespace crumple
