#pragma once

// Bounds on the pointwise depth of two bodies: the greatest distance to the other surface over all points of either
// surface at which the winding number of the other one is not 0 (docs/overlap.md).

#include <array>
#include <span>
#include <vector>

#include "crumple/intersections.h"
#include "search/depth/overlap_depth.h"

namespace crumple {

/// One of two surfaces, and what is known about it.
struct DepthSide {
    const PlacedSurface* surface;
    const WindingSteps* windings;         ///< intervals of winding numbers of the other surface
    std::span<const VertexDepth> depths;  ///< result of find_depths() in the other surface
    const SurfaceTree* tree;              ///< tree of `surface`
};

/// Returns bounds with upper − lower ≤ tolerance, unless that takes more than 2^19 splits of faces of one surface; then
/// the bounds are valid all the same. The least tolerance is 2^-20 of the diagonal of the boxes' intersection, or 2^-40
/// of its largest coordinate if that is more; smaller numbers, negative ones and NaN count as this. Rounding errors may
/// add a small part of the least tolerance to the difference. `pairs`: all pairs of triangles that have a common point.
/// Only faces with a vertex of non-zero winding number and faces in pairs have points inside, because the winding
/// number is constant along a face that the other surface does not meet. The result does not depend on the number of
/// threads. Cost: less than a microsecond for each such face, and some microseconds for each split. A tolerance of 1 %
/// of the depth takes few splits. Most are needed if the depth is nearly constant along a large part of a face: about
/// that part's area, divided by the product of depth and tolerance. Memory, which the meter counts: some 200 bytes
/// for each such face and each split so far, and 1 kB for each split of one round. Throws MemoryMeter::Exceeded.
DepthBounds find_depth_bounds(const std::array<DepthSide, 2>& sides, std::span<const Pair> pairs, double tolerance,
                              ParallelFor& workers, MemoryMeter& meter, Cancellation& cancellation);

}  // namespace crumple
