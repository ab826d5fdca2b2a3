#pragma once

#include <array>
#include <cstdint>
#include <stop_token>

#include "crumple/array.h"
#include "crumple/export.h"
#include "crumple/features.h"
#include "crumple/mesh.h"

namespace crumple {

// Exact decisions about pairs of features that the caller provides, for callers with their own broad phase
// (docs/given_pairs.md). Each decision is that of Detector::find. The functions get no mesh, so they do not skip pairs
// of adjacent features: a pair with a common point touches at the start.
//
// Points are rows of three coordinates, pair after pair, float32 or float64, in host memory. By kind a pair has: the
// vertex and the face's three corners; two ends of each edge; the vertex and the edge's two ends; or two vertices. So k
// pairs have 4k, 4k, 3k or 2k rows. A feature is the closed convex hull of its points, degenerate or not.
//
// Both functions throw Error: invalid_argument if the rows are not a whole number of pairs, or start and end differ in
// size; not_finite, which names the pair and the point; cancelled. Thread-safe. Results are the same bytes for any
// number of threads.

/// Options of pair_impacts().
struct PairImpactQuery {
    double min_distance = 0;        ///< as ImpactQuery::min_distance
    double min_distance_share = 0;  ///< as ImpactQuery::min_distance_share
    int threads = 0;                ///< number of threads; 0: as many as the machine has
    bool approaching_only = false;  ///< as ImpactQuery::approaching_only
};

/// Result of pair_impacts(): one element per pair.
struct PairImpacts {
    Array<std::uint8_t> hit;  ///< 1: the features touch at some time in [0, 1]
    Array<double> toi;        ///< first such time, rounded down: toi <= exact < next number; infinite if there is none
    Array<std::uint8_t> start;  ///< 1: they touch at the start, toi = 0 exactly
};

/// Decides for each pair of one kind if and when the features touch, while each point moves straight from start to end.
/// Cost per pair: about 0.3 us if the features stay apart, 2 us if they touch, 5 to 200 us if only rational arithmetic
/// can decide.
CRUMPLE_API PairImpacts pair_impacts(FeatureKind kind, const VertexView& start, const VertexView& end,
                                     const PairImpactQuery& query = {}, std::stop_token stop = {});

/// Result of pair_distances(): one element per pair.
struct PairDistances {
    Array<double> squared_distance;  ///< exact, rounded to nearest; infinite if it overflows
    Array<std::uint8_t> touching;    ///< 1: the distance is 0 exactly
    /// Closest parts: a VertexFaceType, EdgeEdgeType, VertexEdgeType or VertexVertexType (crumple/proximities.h). EA0,
    /// EB0, and E0 of a vertex and an edge, are the ends that the caller gives first.
    Array<std::uint8_t> type;
    /// Closest points, as parameters: (u, v) of the point a + u (b - a) + v (c - a) of a face a b c; (s, t) of the
    /// points a + s (b - a) and c + t (d - c) of two edges a b and c d; (t, 0) of the point a + t (b - a) of an edge a
    /// b against a vertex; (0, 0) for two vertices. Exact values, each rounded to the nearest number.
    Array<std::array<double, 2>> at;
};

/// Returns the distance of each pair of one kind. `threads`: their number; 0: as many as the machine has. Cost: about
/// 0.6 us per pair.
CRUMPLE_API PairDistances pair_distances(FeatureKind kind, const VertexView& points, int threads = 0,
                                         std::stop_token stop = {});

}  // namespace crumple
