#pragma once

// Two features with their points renumbered so that the guess of their closest points (closest_guess.h) is at s = t =
// 0, at t = 0, or inside the domain of (s, t). So each parameter is either free to grow and fall, or is 0 and can only
// grow. Compiled for host and device.

#include "exact/proximity/closest_guess.h"
#include "exact/proximity/double_word_vec.h"

namespace crumple::detail {

/// Points that make w = x0 - y0, u = x1 - x0, and v = x2 - x0 for a face or y0 - y1 for two edges.
struct Numbering {
    std::array<std::uint8_t, 4> point;  ///< x0, x1, y0, and x2 or y1
    std::uint8_t free;                  ///< number of free parameters
    bool second = false;                ///< true if the only free parameter is t of the guess
};

CRUMPLE_HD inline Numbering numbering(FeatureKinds kinds, std::uint8_t type) {
    constexpr Numbering face[] = {{{1, 2, 0, 3}, 0}, {{2, 3, 0, 1}, 0},       {{3, 1, 0, 2}, 0},
                                  {{1, 2, 0, 3}, 1}, {{2, 3, 0, 1}, 1, true}, {{1, 3, 0, 2}, 1, true},
                                  {{1, 2, 0, 3}, 2}};
    constexpr Numbering edges[] = {{{0, 1, 2, 3}, 0},       {{0, 1, 3, 2}, 0},       {{1, 0, 2, 3}, 0},
                                   {{1, 0, 3, 2}, 0},       {{0, 1, 2, 3}, 1},       {{0, 1, 3, 2}, 1},
                                   {{2, 3, 0, 1}, 1, true}, {{2, 3, 1, 0}, 1, true}, {{0, 1, 2, 3}, 2}};
    constexpr Numbering edge[] = {{{1, 2, 0, 0}, 0}, {{2, 1, 0, 0}, 0}, {{1, 2, 0, 0}, 1}};
    constexpr Numbering vertex = {{0, 0, 1, 0}, 0};
    return kinds == FeatureKinds::vertex_face   ? face[type]
           : kinds == FeatureKinds::edge_edge   ? edges[type]
           : kinds == FeatureKinds::vertex_edge ? edge[type]
                                                : vertex;
}

/// Exact w, u and v, and s and t of the guess. Two vertices have u = v = 0, a vertex and an edge v = 0.
struct VectorsFromGuess {
    Vec3dw w{}, u{}, v{};
    double s = 0, t = 0;
    std::uint8_t free;

    CRUMPLE_HD VectorsFromGuess(const Features& features, const Guess& guess) {
        const Numbering order = numbering(features.kinds, guess.type);
        const auto point = [&](std::size_t i) { return features.point[order.point[i]]; };
        w = exact_difference(point(0), point(2));
        if (features.kinds != FeatureKinds::vertex_vertex) u = exact_difference(point(1), point(0));
        if (features.kinds == FeatureKinds::vertex_face) v = exact_difference(point(3), point(0));
        if (features.kinds == FeatureKinds::edge_edge) v = exact_difference(point(2), point(3));
        free = order.free;
        if (free > 0) s = order.second ? guess.t : guess.s;
        if (free > 1) t = guess.t;
    }
};

/// Returns the ClosestPoints::type whose parts are the first two vertices, one of each feature, at equal positions.
/// There must be such vertices.
CRUMPLE_HD inline std::uint8_t first_common_vertex(const Features& features) {
    const auto& point = features.point;
    std::uint8_t type = 0;
    if (features.kinds == FeatureKinds::edge_edge) {
        while (!(point[type / 2U] == point[2 + type % 2U])) ++type;
    } else {
        while (!(point[0] == point[1U + type])) ++type;
    }
    return type;
}

}  // namespace crumple::detail
