#pragma once

// How far boxes in the frames of two bodies are apart at least, under both bodies' poses; and posed triangles.
//
// Directions are as in box_separation.h: the columns of both poses, which are the axes of the boxes, the line through
// both shapes' middles, and one that the caller knows: from the one body to the other where they are closest. Here they
// are taken as long as makes lengths along them lengths. Along the three axes of a frame gaps are the parts of one
// vector that no two points are closer than, so their squares add up. The columns of a pose that is not rigid are no
// frame; they are shortened until they stretch no vector (Gershgorin's bound on the squares of what they make of it).
//
// Lengths are in units of more than all boxes of both bodies can reach, so the bounds on errors are those of
// box_separation.h. Numbers that leave float64's middle range set nothing apart.

#include <cmath>
#include <cstddef>
#include <limits>

#include "model/box_separation.h"

namespace crumple {

class BoxDistance {
   public:
    static constexpr int lanes = 8;  // the first body's axes, the middles; the second body's axes, the known direction
    using Lanes = float[lanes];

    /// From where to where something reaches along each direction.
    struct Reach {
        alignas(16) Lanes low, high;

        void widen(const Reach& other) {
            for (int i = 0; i < lanes; ++i) {
                low[i] = min(low[i], other.low[i]);
                high[i] = max(high[i], other.high[i]);
            }
        }

        /// Above 0: at most the square of the distance. Else they may touch, and the lower it is the deeper.
        friend float gap(const Reach& a, const Reach& b) {
            alignas(16) Lanes apart, square;
            for (int i = 0; i < lanes; ++i) apart[i] = max(a.low[i] - b.high[i], b.low[i] - a.high[i]);
            for (int i = 0; i < lanes; ++i) square[i] = apart[i] > 0 ? apart[i] * apart[i] : 0;
            for (int i = 0; i < 4; ++i) apart[i] = max(apart[i], apart[i + 4]);
            const float most = max(max(apart[0], apart[1]), max(apart[2], apart[3]));
            if (!(most > 0)) return most;
            return max(max(square[0] + square[1] + square[2], square[3]),
                       max(square[4] + square[5] + square[6], square[7]));
        }
    };

    /// One of both bodies.
    class Side {
       public:
        Reach operator()(const SmallBox& box) const {
            Reach reach;
            const float *m = box.middle, *h = box.half;
            for (int i = 0; i < lanes; ++i) {
                const float middle = offset_[i] + ((along_[0][i] * m[0] + along_[1][i] * m[1]) + along_[2][i] * m[2]);
                const float radius = slack_[i] + ((size_[0][i] * h[0] + size_[1][i] * h[1]) + size_[2][i] * h[2]);
                reach.low[i] = middle - radius;
                reach.high[i] = middle + radius;
            }
            return reach;
        }

        const float* slack() const { return slack_; }

       private:
        friend class BoxDistance;
        alignas(16) Lanes along_[3]{}, size_[3]{}, offset_{}, slack_{};
    };

    /// `known`: any vector, 0 if there is none.
    BoxDistance(const Placement& a, const SmallFrame& frame_a, const Placement& b, const SmallFrame& frame_b,
                const Vec3d& known) {
        const Affine pa = a.matrix(), pb = b.matrix();
        origin_ = pa(frame_a.all.middle);
        const Vec3d apart = pb(frame_b.all.middle) - origin_;
        unit_ = (reach(pa) * frame_a.unit + reach(pb) * frame_b.unit + length(apart)) * (1 + 0x1p-20);
        const double error = a.error(frame_a.all) + b.error(frame_b.all);
        usable_ = unit_ > 0x1p-300 && unit_ < 0x1p300 && error < 0x1p300;
        if (!usable_) unit_ = 1;
        Vec3d n[lanes];
        if (usable_) {
            set_frame(pa, n);
            set_frame(pb, n + 4);
            n[3] = unit_vector(apart);
            n[7] = unit_vector(known);
        }
        for (int i = 0; i < lanes; ++i) {
            set(a_, i, n[i], pa, frame_a.unit);
            set(b_, i, n[i], pb, frame_b.unit);
            b_.offset_[i] = usable_ ? static_cast<float>(dot(n[i], apart) / unit_) : 0;
            a_.slack_[i] = usable_ ? static_cast<float>(2 * error / unit_ * 1.0001 + 0x1p-18)
                                   : std::numeric_limits<float>::infinity();
            for (int axis = 0; axis < 3; ++axis) direction_[axis][i] = static_cast<float>(n[i][axis]);
        }
    }

    const Side& a() const { return a_; }
    const Side& b() const { return b_; }

    /// What gap() is above only of what is farther apart than the distance.
    float limit(double distance) const {
        const double scaled = distance / unit_;
        if (!usable_ || !(scaled < 0x1p50)) return std::numeric_limits<float>::infinity();
        return static_cast<float>(scaled * scaled * (1 + 0x1p-18) + 1e-36);
    }

    /// Where posed vertices lie along each direction, of `count` vertices; triangles of the first body reach slack()
    /// farther to both sides.
    void project(const double* x, const double* y, const double* z, int count, Lanes* at) const {
        const double scale = usable_ ? 1 / unit_ : 0;
        for (int v = 0; v < count; ++v) {
            const auto p = static_cast<float>((x[v] - origin_.x) * scale),
                       q = static_cast<float>((y[v] - origin_.y) * scale),
                       r = static_cast<float>((z[v] - origin_.z) * scale);
            for (int i = 0; i < lanes; ++i)
                at[v][i] = (direction_[0][i] * p + direction_[1][i] * q) + direction_[2][i] * r;
        }
    }

   private:
    static double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }
    static double reach(const Affine& pose) {
        return length(pose.column(0)) + length(pose.column(1)) + length(pose.column(2));
    }
    /// A little shorter than 1; 0 of a vector that has no such length.
    static Vec3d unit_vector(const Vec3d& v) {
        const double squared = dot(v, v);
        if (!(squared > 0x1p-800 && squared < 0x1p800)) return {};
        return (1 - 0x1p-40) / std::sqrt(squared) * v;
    }
    static void set_frame(const Affine& pose, Vec3d* n) {
        double overlap[3]{};
        for (int j = 0; j < 3; ++j) n[j] = unit_vector(pose.column(j));
        for (int j = 0; j < 3; ++j) {
            const double product = std::abs(dot(n[j], n[(j + 1) % 3]));
            overlap[j] += product;
            overlap[(j + 1) % 3] += product;
        }
        const double shorter = 1 / std::sqrt(1 + max(overlap[0], max(overlap[1], overlap[2])));
        for (int j = 0; j < 3; ++j) n[j] = shorter * n[j];
    }
    void set(Side& side, int lane, const Vec3d& n, const Affine& pose, double unit) const {
        for (int j = 0; j < 3; ++j) {
            side.along_[j][lane] = usable_ ? static_cast<float>(dot(n, pose.column(j)) * unit / unit_) : 0;
            side.size_[j][lane] = std::abs(side.along_[j][lane]);
        }
    }

    bool usable_ = false;
    double unit_ = 1;
    Vec3d origin_;
    Side a_, b_;
    alignas(16) Lanes direction_[3];
};

}  // namespace crumple
