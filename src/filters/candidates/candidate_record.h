#pragma once

// Record of a triangle in a leaf (set of triangles that one sweep searches) for candidates: inflated boxes and ids of
// the features that the triangle owns, seven at most, one per SIMD lane.
//
//   lane    0 1 2      3 4 5    6        7
//   holds   vertices   edges    face     nothing
//
// A bound of an inflated box is stored as a key: the sum of coordinate and inflation is rounded, then normalised, taken
// relative to the leaf's origin and rounded to float32. Each step is monotone, so unequal keys have the order of the
// exact sums (box_test.h); equal keys decide nothing. The following lanes hold no box, and overlap nothing: lanes of
// features that another triangle owns, lane 7, and lane 6 of a proxy triangle (a degenerate triangle that owns an edge
// or a point which no other triangle owns, and that is not a face: scene/scene_features.h). A representative vertex
// stands for all vertices that welding merges; without welding it is the vertex itself. Compiled for host and device.

#include <cstdint>

#include "crumple/candidates.h"
#include "geometry/leaf_frame.h"
#include "geometry/normaliser.h"
#include "queries/feature_request.h"

namespace crumple {

inline constexpr int candidate_lanes = 8;
inline constexpr unsigned vertex_lanes = 0b111, edge_lanes = 0b111000, face_lane = 0b1000000;

struct alignas(64) CandidateRecord {
    float low[3][candidate_lanes], high[3][candidate_lanes];  ///< by axis and lane
    /// Ids by lane: of the points at the corners, of the edges, and of the triangle.
    std::int32_t id[candidate_lanes];
    std::int32_t vertex[3];  ///< corners
    std::int32_t name[4];    ///< representative vertices of the corners; the last one is -1
    std::uint32_t owned;     ///< 1 bit per lane: set if the triangle owns the lane's feature
};

/// Returns the lanes of the features that a triangle or a proxy triangle owns. `owned`: bits of its vertices and edges
/// (SceneFeatures::owned); `face`: false for a proxy triangle.
CRUMPLE_HD constexpr unsigned owned_lanes(unsigned owned, bool face) {
    return (owned & (vertex_lanes | edge_lanes)) | (face ? face_lane : 0);
}

/// Returns the type of a lane's feature; face for lane 7, too, which has none.
CRUMPLE_HD constexpr FeatureType type_of(int lane) {
    return lane < 3 ? FeatureType::vertex : lane < 6 ? FeatureType::edge : FeatureType::face;
}

/// Returns the kind of a pair of features by their lanes, in either order.
CRUMPLE_HD constexpr CandidateKind kind_of(int a, int b) {
    constexpr CandidateKind kind[3][3] = {
        {CandidateKind::vertex_vertex, CandidateKind::vertex_edge, CandidateKind::vertex_face},
        {CandidateKind::vertex_edge, CandidateKind::edge_edge, CandidateKind::edge_face},
        {CandidateKind::vertex_face, CandidateKind::edge_face, CandidateKind::face_face}};
    return kind[static_cast<std::size_t>(type_of(a))][static_cast<std::size_t>(type_of(b))];
}

/// Returns the corners of a lane's feature, as bits.
CRUMPLE_HD constexpr unsigned corners_of(int lane) {
    constexpr std::uint8_t corners[candidate_lanes] = {0b001, 0b010, 0b100, 0b011, 0b110, 0b101, 0b111, 0};
    return corners[lane];
}

/// Common vertices of two triangles: of[i] has a bit for each corner of b that equals corner i of a.
struct SharedCorners {
    unsigned of[3] = {0, 0, 0};

    CRUMPLE_HD SharedCorners(const CandidateRecord& a, const CandidateRecord& b) : SharedCorners(a.name, b.name) {}
    /// Compares the representative vertices of three corners each.
    CRUMPLE_HD SharedCorners(const std::int32_t* a, const std::int32_t* b) {
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k) of[i] |= unsigned{a[i] == b[k]} << k;
    }
    /// Reads what bits() has returned.
    CRUMPLE_HD explicit SharedCorners(unsigned bits) : of{bits & 7, bits >> 3 & 7, bits >> 6 & 7} {}
    CRUMPLE_HD unsigned bits() const { return of[0] | of[1] << 3 | of[2] << 6; }
    /// Returns true if the features of two lanes have a common vertex.
    CRUMPLE_HD bool incident(int lane_a, int lane_b) const {
        unsigned shared = 0;
        for (int i = 0; i < 3; ++i)
            if (corners_of(lane_a) >> i & 1) shared |= of[i];
        return (shared & corners_of(lane_b)) != 0;
    }
};

/// Bounds of a lane that overlaps nothing: its lows are `beyond`, its highs -beyond.
inline constexpr float beyond = 3e38f;

/// Keys are clamped to this magnitude. Normalised coordinates and origins are at most 1 in magnitude, so it does not
/// matter where exactly an inflated box ends outside of that range.
inline constexpr double farthest_key = 8;

/// Computes the keys of a corner of an inflated box. `origin`: the leaf's origin, in normalised coordinates.
struct CandidateKey {
    const Normaliser& normaliser;
    Vec3d origin;

    CRUMPLE_HD Vec3f operator()(const Vec3d& grown) const {
        const Vec3d p = normaliser(grown) - origin;
        return to_float(max(Vec3d{-farthest_key, -farthest_key, -farthest_key},
                            min(Vec3d{farthest_key, farthest_key, farthest_key}, p)));
    }
};

}  // namespace crumple
