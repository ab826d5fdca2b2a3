#pragma once

// Whether boxes in the frames of two bodies are certainly apart, under both bodies' poses.
//
// A box with middle c and half extent h under the pose (P | t) is the set of all P (c + d) + t with |d| <= h by axis: a
// parallelepiped. Along any direction n it reaches from n . (P c + t) by the sum over its axes of |n . P_j| h_j to both
// sides. Directions that are tried: the columns of both poses, which are the boxes' face normals as long as poses are
// rigid (S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree", 1996, whose other nine directions part few boxes more). A
// direction may be any vector, so poses that scale or flatten cost tightness only.
//
// Boxes are given in float32, relative to the middle of the shape and in units of its extent. Lengths along a direction
// are taken in units of what all boxes of both bodies can reach, so no number exceeds 1 by much and no sum of
// magnitudes exceeds 2; each of them is rounded nine times at most, which `slack` covers twice. It also covers that
// vertices are rounded (Placement::error). A direction whose numbers leave float64's middle range parts nothing.

#include <cmath>
#include <limits>

#include "model/placement.h"

namespace crumple {

/// A box of some triangles of a shape, as BoxSeparation takes it.
struct SmallBox {
    float middle[3], half[3];
};

/// Where a shape's small boxes are: its whole box, and the unit of length, a power of two.
struct SmallFrame {
    CentredBox all;
    double unit = 1;

    SmallFrame() = default;
    explicit SmallFrame(const CentredBox& box) : all(box) {
        const double extent = largest(box.half);
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
    /// Holds what the small box was made of.
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

class BoxSeparation {
   public:
    BoxSeparation(const Placement& a, const SmallFrame& frame_a, const Placement& b, const SmallFrame& frame_b) {
        const Affine pa = a.matrix(), pb = b.matrix();
        const Vec3d apart = pb(frame_b.all.middle) - pa(frame_a.all.middle);
        const double error = a.error(frame_a.all) + b.error(frame_b.all);
        for (int i = 0; i < lanes; ++i) {
            offset_[i] = 0;
            slack_[i] = std::numeric_limits<float>::infinity();
            for (int j = 0; j < 3; ++j) a_[j][i] = b_[j][i] = size_a_[j][i] = size_b_[j][i] = 0;
        }
        for (int i = 0; i < 6; ++i) {
            const Vec3d n = i < 3 ? pa.column(i) : pb.column(i - 3);
            double along_a[3], along_b[3], reach = 0;
            for (int j = 0; j < 3; ++j) {
                along_a[j] = dot(n, pa.column(j)) * frame_a.unit;
                along_b[j] = dot(n, pb.column(j)) * frame_b.unit;
                reach += std::abs(along_a[j]) + std::abs(along_b[j]);
            }
            const double offset = dot(n, apart), one_norm = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
            const double scale = 1 / (reach + std::abs(offset));
            if (!(scale > 0x1p-800 && scale < 0x1p800 && one_norm * error < 0x1p800)) continue;
            for (int j = 0; j < 3; ++j) {
                a_[j][i] = static_cast<float>(along_a[j] * scale), size_a_[j][i] = std::abs(a_[j][i]);
                b_[j][i] = static_cast<float>(along_b[j] * scale), size_b_[j][i] = std::abs(b_[j][i]);
            }
            offset_[i] = static_cast<float>(offset * scale);
            slack_[i] = static_cast<float>(one_norm * error * scale) * 1.0001f + 0x1p-18f;
        }
    }

    /// The largest distance of the boxes along a direction, in no unit: above 0, they are certainly apart.
    float gap(const SmallBox& a, const SmallBox& b) const {
        float apart[lanes];
        for (int i = 0; i < lanes; ++i) {
            const float distance = offset_[i] +
                                   ((b_[0][i] * b.middle[0] - a_[0][i] * a.middle[0]) +
                                    (b_[1][i] * b.middle[1] - a_[1][i] * a.middle[1])) +
                                   (b_[2][i] * b.middle[2] - a_[2][i] * a.middle[2]);
            const float radius = slack_[i] +
                                 ((size_a_[0][i] * a.half[0] + size_a_[1][i] * a.half[1]) +
                                  (size_a_[2][i] * a.half[2] + size_b_[0][i] * b.half[0])) +
                                 (size_b_[1][i] * b.half[1] + size_b_[2][i] * b.half[2]);
            apart[i] = std::abs(distance) - radius;
        }
        return max(max(max(apart[0], apart[1]), max(apart[2], apart[3])), max(apart[4], apart[5]));
    }

   private:
    static constexpr int lanes = 8;  // the last two are not used
    using Lanes = float[lanes];

    alignas(32) Lanes a_[3], b_[3], size_a_[3], size_b_[3], offset_, slack_;
};

}  // namespace crumple
