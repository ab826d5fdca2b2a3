#pragma once

// Members that are far larger than their leaf: two ground triangles under fine cloth, say. If they entered the leaf's
// range of quantisation and its error bound they would ruin both for everybody. So their boxes are clamped to the leaf
// and their corners are NaN, which no filter decides anything from; only their plane, computed in float64, still
// separates small members from them ([MZ] 5.1; measured in docs/unequal_sizes.md).

#include <cmath>
#include <limits>

#include "cpu/layout.h"

namespace crumple::cpu {

/// Rewrites the record and widens the box of a member that reaches `reach` > frame.big from the origin.
/// `p`: its corners relative to the leaf's origin.
inline void make_big(const Vec3d p[3], const Vec3d& a, const Vec3d& b, float reach, Record& record, BoxCorner& low,
                     BoxCorner& high) {
    // A box's error grows with its own coordinates: 8 u each side would do, see docs/align.md.
    const float margin = 16 * 0x1p-24f * reach;
    low = {low.x - margin, low.y - margin, low.z - margin, 0};
    high = {high.x + margin, high.y + margin, high.z + margin, 0};
    const double sum = (std::abs(a.y * b.z) + std::abs(a.z * b.y)) + (std::abs(a.z * b.x) + std::abs(a.x * b.z)) +
                       (std::abs(a.x * b.y) + std::abs(a.y * b.x)) + 1e-30;
    const Vec3d n = (1 / sum) * cross(a, b);
    for (int k = 0; k < 3; ++k) record.x[k] = record.y[k] = record.z[k] = std::numeric_limits<float>::quiet_NaN();
    record.x[3] = static_cast<float>(n.x);
    record.y[3] = static_cast<float>(n.y);
    record.z[3] = static_cast<float>(n.z);
    record.c = static_cast<float>(dot(n, p[0]));
}

}  // namespace crumple::cpu
