#pragma once

// Decides if boxes in the frames of two bodies are certainly apart, under both bodies' poses.
//
// A box with middle c and half extent h under the pose (P | t) is the set of all P (c + d) + t with |d_j| <= h_j: a
// parallelepiped. Along any direction n it extends by the sum over its axes of |n . P_j| h_j to both sides of n . (P c
// + t). The directions are the columns of both poses, which are the boxes' face normals if the poses are rigid (S.
// Gottschalk, M. C. Lin, D. Manocha, "OBBTree", 1996, whose other nine directions separate few more boxes), and the
// line through the middles of both shapes. A direction may be any vector, so poses that scale or flatten only cost
// tightness.
//
// Directions do not depend on the boxes. So a box's interval along each direction is computed once, and compared with
// many others.
//
// Boxes are given in float32, relative to the middle of the shape and in units of its extent. Along a direction, the
// unit of length is the extent of all boxes of both bodies, so no number exceeds 1 by much and no sum of magnitudes
// exceeds 2; each number is rounded at most nine times, and `slack` is at least twice the bound on the resulting error.
// `slack` also covers the rounding of vertices (Placement::error). A direction whose numbers leave float64's middle
// range separates nothing.

#include <cmath>
#include <limits>

#include "scene/placement.h"

namespace crumple {

/// Box of some triangles of a shape, relative to a SmallFrame.
struct SmallBox {
    float middle[3], half[3];
};

/// Frame of a shape's small boxes: the box of the shape, and the unit of length, a power of two. If the shape extends
/// nearly as far as the largest float64 number, the unit is infinite; then the boxes become NaN where they are used,
/// and nothing counts as apart.
struct SmallFrame {
    CentredBox all;
    double unit = 1;

    SmallFrame() = default;
    explicit SmallFrame(const CentredBox& box) : all(box) {
        const double extent = largest(box.half);
        if (!(extent < 0x1p1023))
            unit = std::numeric_limits<double>::infinity();
        else
            unit = extent > 0x1p-900 ? std::ldexp(1.0, std::ilogb(extent) + 1) : 0x1p-900;
    }
    SmallBox operator()(const CentredBox& box) const {
        SmallBox small;
        for (int axis = 0; axis < 3; ++axis) {
            const double middle = (box.middle[axis] - all.middle[axis]) / unit;
            small.middle[axis] = static_cast<float>(middle);
            small.half[axis] = static_cast<float>(box.half[axis] / unit * (1 + 0x1p-22) + 0x1p-22);
        }
        return small;
    }
    /// Returns a box that contains the one that `small` was made from.
    CentredBox box(const SmallBox& small) const {
        CentredBox box;
        for (int axis = 0; axis < 3; ++axis) {
            const double middle = static_cast<double>(small.middle[axis]) * unit + all.middle[axis];
            box.middle[axis] = middle;
            box.half[axis] = static_cast<double>(small.half[axis]) * unit + 0x1p-50 * std::abs(middle);
        }
        return box;
    }
};

class SeparatingBoxes {
   public:
    static constexpr int lanes = 8;  // the last one is not used
    using Lanes = float[lanes];

    /// Interval of a box along each direction.
    struct Intervals {
        alignas(16) Lanes low, high;

        /// Returns the largest gap along any direction. Only its sign has a meaning: above 0, the boxes are certainly
        /// apart.
        friend float gap(const Intervals& a, const Intervals& b) {
            Lanes apart;
            for (int i = 0; i < lanes; ++i) apart[i] = max(a.low[i] - b.high[i], b.low[i] - a.high[i]);
            for (int i = 0; i < 4; ++i) apart[i] = max(apart[i], apart[i + 4]);
            return max(max(apart[0], apart[1]), max(apart[2], apart[3]));
        }
    };

    /// Computes intervals for the boxes of one of the two bodies.
    class Side {
       public:
        Intervals operator()(const SmallBox& box) const {
            Intervals reach;
            const float *m = box.middle, *h = box.half;
            for (int i = 0; i < lanes; ++i) {
                const float middle = offset_[i] + ((along_[0][i] * m[0] + along_[1][i] * m[1]) + along_[2][i] * m[2]);
                const float radius = slack_[i] + ((size_[0][i] * h[0] + size_[1][i] * h[1]) + size_[2][i] * h[2]);
                reach.low[i] = middle - radius;
                reach.high[i] = middle + radius;
            }
            return reach;
        }

       private:
        friend class SeparatingBoxes;

        void set(int lane, const double along[3], double scale, double offset, double slack) {
            for (int j = 0; j < 3; ++j) {
                along_[j][lane] = static_cast<float>(along[j] * scale);
                size_[j][lane] = std::abs(along_[j][lane]);
            }
            offset_[lane] = static_cast<float>(offset * scale);
            slack_[lane] = static_cast<float>(slack);
        }

        alignas(16) Lanes along_[3]{}, size_[3]{}, offset_{}, slack_{};
    };

    SeparatingBoxes(const Placement& a, const SmallFrame& frame_a, const Placement& b, const SmallFrame& frame_b) {
        const Affine pa = a.matrix(), pb = b.matrix();
        const Vec3d apart = pb(frame_b.all.middle) - pa(frame_a.all.middle);
        const double error = a.error(frame_a.all) + b.error(frame_b.all);
        for (int i = 0; i < lanes; ++i) {
            a_.slack_[i] = std::numeric_limits<float>::infinity();
            if (i == 7) break;
            const Vec3d n = i < 3 ? pa.column(i) : i < 6 ? pb.column(i - 3) : apart;
            double along_a[3], along_b[3], reach = 0;
            for (int j = 0; j < 3; ++j) {
                along_a[j] = dot(n, pa.column(j)) * frame_a.unit;
                along_b[j] = dot(n, pb.column(j)) * frame_b.unit;
                reach += std::abs(along_a[j]) + std::abs(along_b[j]);
            }
            const double offset = dot(n, apart), one_norm = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
            const double scale = 1 / (reach + std::abs(offset));
            if (!(scale > 0x1p-800 && scale < 0x1p800 && one_norm * error < 0x1p800)) continue;
            a_.set(i, along_a, scale, 0, one_norm * error * scale * 1.0001 + 0x1p-18);
            b_.set(i, along_b, scale, offset, 0);
        }
    }

    const Side& a() const { return a_; }
    const Side& b() const { return b_; }

   private:
    Side a_, b_;
};

}  // namespace crumple
