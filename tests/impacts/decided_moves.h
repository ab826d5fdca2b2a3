#pragma once

// The moves of tests, as float64 decides them.

#include "exact/impact/decide_impact.h"
#include "exact/impact/quick_impact.h"
#include "impacts/moves.h"

namespace crumple {

/// Of a vertex and a face, or two edges.
inline QuickImpact quickly(const Move& move) {
    return move.feature == Feature::vertex_face ? quick_impact<FeaturePair::vertex_face>(move.point)
                                                : quick_impact<FeaturePair::edge_edge>(move.point);
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
