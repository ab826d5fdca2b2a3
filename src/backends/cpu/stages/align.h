#pragma once

// Stage `align`: the frame in which a leaf is swept, by principal component analysis of its members' centroids
// ([MZ] sec. 3, eq. 1), and its members' boxes in that frame. These are written by the question's `build`, beside its
// records, from one gather of the corners.
//
// The first axis is the one along which the centroids spread most. Up to 128 members, evenly spaced in the list, stand
// for all. The other two are turned so that edges, those of 32 members, lie along them. Any frame is correct; boxes
// carry a margin that covers the rounding of the rotation (docs/align.md).

#include "backends/cpu/stages/leaf_members.h"

namespace crumple::cpu {

/// `corners`: 3 a triangle.
LeafFrame leaf_frame(const Array<Ball>& balls, const PointRows& points, const std::int32_t* corners,
                     const LeafMembers& members);

/// Writes the box of the leaf's member i and takes it into account: what a plain `build` does, member by member.
template <int corners>
void add_box(const InFrame<corners>& member, std::int64_t i, Boxes& boxes, LeafBounds& bounds) {
    boxes.low[static_cast<std::size_t>(i)] = {member.low.x, member.low.y, member.low.z, 0};
    boxes.high[static_cast<std::size_t>(i)] = {member.high.x, member.high.y, member.high.z, 0};
    bounds.reach = max(bounds.reach, member.counted_reach());
    bounds.big += member.big;
    if (member.big) return;
    bounds.low = min(bounds.low, member.low);
    bounds.high = max(bounds.high, member.high);
}

}  // namespace crumple::cpu
