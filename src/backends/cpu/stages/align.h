#pragma once

// Stage `align`: the frame in which a leaf, a small set of triangles, is swept, by principal component analysis of its
// members' centroids (sec. 3, eq. 1 of [MZ], the paper cited in ARCHITECTURE.md), and its members' boxes in that frame.
// The query's `build` (LeafQuery::build) writes the boxes, together with its records, from one gather of the corners.
//
// The first axis is the direction in which the centroids spread most, estimated from up to 128 members that are evenly
// spaced in the list, unless the options choose another one. The other two axes are turned to lie along the edges of up
// to 32 of these members. Any frame is correct; boxes carry a margin that covers the rounding of the rotation
// (docs/align.md).

#include "backends/cpu/stages/leaf_members.h"
#include "crumple/options.h"

namespace crumple::cpu {

/// Returns the frame of a leaf, whose first axis is Method::sweep. `corners`: 3 per triangle.
LeafFrame leaf_frame(const Array<Ball>& balls, const PointRows& points, const std::int32_t* corners,
                     const LeafMembers& members, const Method& method = {});

/// Returns the mean displacement during the step of one corner each of up to 32 members; 0 if the scene is static.
/// `ends`: see BuildInput.
Vec3f mean_motion(const PointRows& points, const std::int32_t* corners, std::int64_t ends, const LeafMembers& members);

/// Writes the box of the leaf's member i and updates the leaf's bounds, for a `build` without SIMD.
template <int corners>
void add_box(const InFrame<corners>& member, std::int64_t i, Boxes& boxes, LeafBounds& bounds) {
    boxes.low[static_cast<std::size_t>(i)] = {member.low.x, member.low.y, member.low.z, 0};
    boxes.high[static_cast<std::size_t>(i)] = {member.high.x, member.high.y, member.high.z, 0};
    bounds.reach = max(bounds.reach, member.counted_extent());
    bounds.big += member.big;
    if (member.big) return;
    bounds.low = min(bounds.low, member.low);
    bounds.high = max(bounds.high, member.high);
}

}  // namespace crumple::cpu
