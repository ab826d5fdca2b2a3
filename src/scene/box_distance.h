#pragma once

// Lower bound on the distance of two objects of different bodies. An object is a posed triangle, or a box in its body's
// frame under the body's pose.
//
// Objects are projected to eight directions. Seven are those of separating_boxes.h: the columns of both poses, which
// are the axes of the boxes, and the line through the middles of both shapes. The caller gives the eighth: the line
// between the closest points found so far, if there are any. All directions have a length of at most 1, so a gap along
// one of them is no longer than the distance. If the three columns of a pose are orthonormal, the gaps along them are
// the components of a vector that is no longer than the distance, so the squares of the gaps add up. The columns of a
// pose that is not rigid are shortened until this holds: until their matrix lengthens no vector (by Gershgorin's bound
// on the eigenvalues of their Gram matrix).
//
// For a step, in which vertices move straight from their start to their end, the interval of a box contains the box at
// both times, so all trajectories of its vertices; the directions are those of the poses at the start.
//
// The unit of length exceeds the extent of all boxes of both bodies together, so the error bounds are those of
// separating_boxes.h. If numbers leave float64's middle range, nothing is separated.

#include <cmath>
#include <limits>

#include "scene/separating_boxes.h"

namespace crumple {

/// Vector of four float32 numbers. Two (geometry/two.h) is the same for two float64 numbers.
using Four = float __attribute__((vector_size(16)));
inline Four least(Four x, Four y) { return x < y ? x : y; }
inline Four most(Four x, Four y) { return x > y ? x : y; }

class BoxDistance {
   public:
    /// One number per direction. `first`: the first body's three axes and the line through the middles of the shapes.
    /// `second`: the second body's three axes and the direction that the caller gives.
    struct Lanes {
        Four first{}, second{};
    };

    /// Interval of an object along each direction.
    struct Intervals {
        Lanes low, high;

        void widen(const Intervals& other) {
            low = {least(low.first, other.low.first), least(low.second, other.low.second)};
            high = {most(high.first, other.high.first), most(high.second, other.high.second)};
        }

        /// If the result is above 0, it is a lower bound on the squared distance of the objects, to be compared with
        /// limit(). Else the objects may touch, and the lower the result, the deeper their intervals overlap.
        friend float gap(const Intervals& a, const Intervals& b) {
            const Four first = most(a.low.first - b.high.first, b.low.first - a.high.first),
                       second = most(a.low.second - b.high.second, b.low.second - a.high.second);
            const Four zero{}, p = most(zero, first) * most(zero, first), q = most(zero, second) * most(zero, second);
            const float squared = max(max(p[0] + p[1] + p[2], p[3]), max(q[0] + q[1] + q[2], q[3]));
            if (squared > 0) return squared;
            const Four both = most(first, second);
            return min(max(max(both[0], both[1]), max(both[2], both[3])), 0.0f);
        }
    };

    /// Computes intervals of the boxes and triangles of one of the two bodies.
    class Side {
       public:
        Intervals operator()(const SmallBox& box) const { return interval(start_, box); }

        /// Returns the interval of a box during the step; without a step, undefined.
        Intervals swept(const SmallBox& box) const {
            Intervals all = interval(start_, box);
            all.widen(interval(end_, box));
            return all;
        }

        /// Returns the interval of a triangle. p, q and r: its posed vertices along each direction
        /// (BoxDistance::operator()).
        Intervals operator()(const Lanes& p, const Lanes& q, const Lanes& r) const {
            return {{least(p.first, least(q.first, r.first)) - slack_.first,
                     least(p.second, least(q.second, r.second)) - slack_.second},
                    {most(p.first, most(q.first, r.first)) + slack_.first,
                     most(p.second, most(q.second, r.second)) + slack_.second}};
        }

       private:
        friend class BoxDistance;
        /// Projection of the coordinates of small boxes to the directions, under one pose.
        struct Projection {
            Lanes along[3], size[3], offset;
        };
        Intervals interval(const Projection& to, const SmallBox& box) const {
            Lanes middle = to.offset, radius = slack_;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                middle.first += to.along[axis].first * box.middle[axis];
                middle.second += to.along[axis].second * box.middle[axis];
                radius.first += to.size[axis].first * box.half[axis];
                radius.second += to.size[axis].second * box.half[axis];
            }
            return {{middle.first - radius.first, middle.second - radius.second},
                    {middle.first + radius.first, middle.second + radius.second}};
        }
        Projection start_, end_;
        Lanes slack_;
    };

    /// `known`: the eighth direction, of any length; the zero vector if there is none.
    BoxDistance(const Placement& a, const SmallFrame& frame_a, const Placement& b, const SmallFrame& frame_b,
                const Vec3d& known) {
        const Affine pa = a.matrix(), pb = b.matrix();
        set_directions(pa, frame_a, pb, frame_b, known, 0, a.error(frame_a.all) + b.error(frame_b.all));
        set(a_.start_, pa, frame_a);
        set(b_.start_, pb, frame_b);
    }

    /// Placements of a body at both ends of a step.
    struct Step {
        Placement start, end;
    };
    BoxDistance(const Step& a, const SmallFrame& frame_a, const Step& b, const SmallFrame& frame_b) {
        const Affine pa = a.start.matrix(), pb = b.start.matrix(), qa = a.end.matrix(), qb = b.end.matrix();
        const Vec3d origin = pa(frame_a.all.middle);
        const double extent_at_end = reach(qa) * frame_a.unit + reach(qb) * frame_b.unit +
                                     length(qa(frame_a.all.middle) - origin) + length(qb(frame_b.all.middle) - origin);
        const double error = a.start.error(frame_a.all) + b.start.error(frame_b.all) + a.end.error(frame_a.all) +
                             b.end.error(frame_b.all);
        set_directions(pa, frame_a, pb, frame_b, {}, extent_at_end, error);
        set(a_.start_, pa, frame_a);
        set(b_.start_, pb, frame_b);
        set(a_.end_, qa, frame_a);
        set(b_.end_, qb, frame_b);
    }

    const Side& a() const { return a_; }
    const Side& b() const { return b_; }

    /// Returns a threshold: if gap() exceeds it, the distance exceeds `distance`.
    float limit(double distance) const {
        const double scaled = distance / unit_;
        if (!usable_ || !(scaled < 0x1p50)) return std::numeric_limits<float>::infinity();
        return static_cast<float>(scaled * scaled * (1 + 0x1p-18) + 1e-36);
    }

    /// Returns the position of a posed vertex along each direction.
    Lanes operator()(const Vec3d& vertex) const {
        if (!usable_) return {};
        const double scale = 1 / unit_;
        const auto x = static_cast<float>((vertex.x - origin_.x) * scale),
                   y = static_cast<float>((vertex.y - origin_.y) * scale),
                   z = static_cast<float>((vertex.z - origin_.z) * scale);
        return {(direction_[0].first * x + direction_[1].first * y) + direction_[2].first * z,
                (direction_[0].second * x + direction_[1].second * y) + direction_[2].second * z};
    }

   private:
    static double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }
    static double reach(const Affine& pose) {
        return length(pose.column(0)) + length(pose.column(1)) + length(pose.column(2));
    }
    /// Returns v scaled to slightly less than length 1; the zero vector if its squared length is not between 2^-800 and
    /// 2^800.
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
    // Sets the unit of length, the directions, and the slack. `further`: an extent to add to the unit.
    void set_directions(const Affine& pa, const SmallFrame& frame_a, const Affine& pb, const SmallFrame& frame_b,
                        const Vec3d& known, double further, double error) {
        origin_ = pa(frame_a.all.middle);
        const Vec3d apart = pb(frame_b.all.middle) - origin_;
        unit_ = (reach(pa) * frame_a.unit + reach(pb) * frame_b.unit + length(apart) + further) * (1 + 0x1p-20);
        usable_ = unit_ > 0x1p-300 && unit_ < 0x1p300 && error < 0x1p300;
        if (!usable_) unit_ = 1;
        if (usable_) {
            set_frame(pa, n_);
            set_frame(pb, n_ + 4);
            n_[3] = unit_vector(apart);
            n_[7] = unit_vector(known);
        }
        for (int i = 0; i < lanes; ++i) {
            lane(a_.slack_, i,
                 usable_ ? 2 * error / unit_ * 1.0001 + 0x1p-18 : std::numeric_limits<double>::infinity());
            for (int axis = 0; axis < 3; ++axis) lane(direction_[axis], i, n_[i][axis]);
        }
    }
    void set(Side::Projection& to, const Affine& pose, const SmallFrame& frame) const {
        if (!usable_) return;
        const Vec3d from_origin = pose(frame.all.middle) - origin_;
        for (int i = 0; i < lanes; ++i) {
            lane(to.offset, i, dot(n_[i], from_origin) / unit_);
            for (int j = 0; j < 3; ++j) {
                const double along = dot(n_[i], pose.column(j)) * frame.unit / unit_;
                lane(to.along[j], i, along);
                lane(to.size[j], i, std::abs(static_cast<float>(along)));
            }
        }
    }
    static void lane(Lanes& lanes, int i, double x) {
        (i < 4 ? lanes.first : lanes.second)[i % 4] = static_cast<float>(x);
    }

    static constexpr int lanes = 8;
    bool usable_ = false;
    double unit_ = 1;
    Vec3d origin_, n_[lanes];  ///< origin of the directions, and the directions
    Side a_, b_;
    Lanes direction_[3];
};

}  // namespace crumple
