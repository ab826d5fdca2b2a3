#pragma once

// Functions that decide the moves of tests in float64.

#include "exact/impact/decide_impact.h"
#include "exact/impact/filtered_impact.h"
#include "impacts/moves.h"

namespace crumple {

/// Returns the float64 verdict on a vertex and a face, or on two edges.
inline FilteredImpact quickly(const Move& move) {
    return move.feature == Feature::vertex_face ? filtered_impact<FeaturePair::vertex_face>(move.point)
                                                : filtered_impact<FeaturePair::edge_edge>(move.point);
}

inline bool surely_apart(const Move& move) {
    return move.feature == Feature::vertex_face ? surely_apart<FeaturePair::vertex_face>(move.point)
                                                : surely_apart<FeaturePair::edge_edge>(move.point);
}

inline Impact decide(const Move& move, ImpactCounts& counts) {
    const auto& [p, q, r, s] = move.point;
    return move.feature == Feature::vertex_face ? vertex_face_impact(p, q, r, s, counts)
                                                : edge_edge_impact(p, q, r, s, counts);
}

}  // namespace crumple
