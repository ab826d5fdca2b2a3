#pragma once

// Input of the sums over an overlap: two bodies, the results of a device, and the ends of the segments in
// which faces cross. Host only.

#include <array>
#include <span>

#include "backends/overlap_device.h"
#include "search/overlap/overlap_windings.h"

namespace crumple {

/// Surfaces of two bodies under their poses, and the origin of the sums over their overlap.
struct SurfacePair {
    std::array<const PlacedSurface*, 2> surface{};
    Vec3d origin;

    bool in_range() const { return surface[0]->in_range && surface[1]->in_range; }
    FaceCorners corners(std::size_t side, std::int32_t face) const { return surface[side]->corners(face); }
    FaceCorners corners_a(const Segment& s) const { return corners(0, s.a); }
    FaceCorners corners_b(const Segment& s) const { return corners(1, s.b); }
};

/// Results of a device for a row: crossings and sums of its pairs, and the device's copies of both surfaces.
struct RowOnDevice {
    OverlapDevice* device = nullptr;
    std::array<std::int32_t, 2> surface{};  ///< indices of both surfaces on the device
    std::span<const PackedCrossings> crossings;
    std::span<const SegmentTerms> sums;
};

inline CrossingEdge crossing_edge(const SurfacePair& surfaces, const Segment& segment, const SegmentEnd& end) {
    return {surfaces.corners_a(segment), surfaces.corners_b(segment), end};
}

}  // namespace crumple
