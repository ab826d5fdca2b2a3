#pragma once

#include <array>
#include <cstdint>
#include <stop_token>

#include "crumple/array.h"
#include "crumple/export.h"
#include "crumple/features.h"
#include "crumple/mesh.h"

namespace crumple {

// Exact decisions about pairs of features that are given, for those who have a broad phase of their own
// (docs/given_pairs.md). The decisions are those of Detector::find, pair by pair. Nothing is
// known of meshes, so nothing is left out as a neighbour.
//
// Points lie in rows, pair after pair, float32 or float64, in host memory, as the kind has them: the vertex, then the
// face's three corners; the two ends of the one edge, then those of the other; the vertex, then the edge's ends; or two
// vertices. So k pairs have 4k, 4k, 3k or 2k rows. A feature is the closed convex hull of its points, collapsed or not.
//
// Both throw Error: invalid_argument where the rows are no whole number of pairs, or the start has not as many as the
// end; not_finite, which names the pair and the point; cancelled. Thread-safe. Answers are the same bytes for every
// number of threads.

/// When two features of a pair count as touching, and how many threads decide it.
struct PairImpactQuery {
    double min_distance = 0;        ///< as ImpactQuery::min_distance
    double min_distance_share = 0;  ///< as ImpactQuery::min_distance_share
    int threads = 0;                ///< 0: as many as the machine has
    bool approaching_only = false;  ///< as ImpactQuery::approaching_only
};

/// One element a pair.
struct PairImpacts {
    Array<std::uint8_t> hit;    ///< 1: they touch at some time in [0, 1]
    Array<double> toi;          ///< the first such time, rounded down: toi <= exact < next number; infinite without one
    Array<std::uint8_t> start;  ///< 1: they touch at the start, toi = 0 exactly
};

/// Returns what pairs of one kind do while each point goes straight from its start to its end. Cost: some 0.3 us for a
/// pair that is apart, some 2 us for one that touches, 5 to 200 us where only rational arithmetic can tell.
CRUMPLE_API PairImpacts pair_impacts(FeatureKind kind, const VertexView& start, const VertexView& end,
                                     const PairImpactQuery& query = {}, std::stop_token stop = {});

/// One element a pair.
struct PairDistances {
    Array<double> squared_distance;  ///< exact, then rounded to the nearest number; infinite beyond the largest
    Array<std::uint8_t> touching;    ///< 1: the distance is 0 exactly
    /// Which parts are closest: a VertexFaceType, an EdgeEdgeType or a VertexEdgeType, whose EA0 and E0 are the first
    /// end given, or a VertexVertexType.
    Array<std::uint8_t> type;
    /// Where: (u, v) of the face's point a + u (b - a) + v (c - a), (s, t) of the edges' a + s (b - a) and
    /// c + t (d - c), (t, 0) of the one edge's a + t (b - a), (0, 0) of two vertices. Exact, then rounded.
    Array<std::array<double, 2>> at;
};

/// Returns how far apart pairs of one kind are. `threads`: 0: as many as the machine has. Cost: some 0.6 us a pair.
CRUMPLE_API PairDistances pair_distances(FeatureKind kind, const VertexView& points, int threads = 0,
                                         std::stop_token stop = {});

}  // namespace crumple
