#pragma once

// Stage `align`: the frame in which a leaf is swept, by principal component analysis of its members' centroids
// ([MZ] sec. 3, eq. 1), and its members' records and boxes in that frame.
//
// The first axis is the one along which the centroids spread most. Up to 128 members, evenly spaced in the list, stand
// for all. The other two are turned so that edges, those of 32 members, lie along them. Any frame is correct; boxes
// carry a margin that covers the rounding of the rotation (docs/align.md).

#include "engine/cpu/leaf_members.h"

namespace crumple::cpu {

/// `corners`: 3 a triangle.
LeafFrame leaf_frame(const Array<Ball>& balls, const PointRows& points, const std::int32_t* corners,
                     const LeafMembers& members);

}  // namespace crumple::cpu
