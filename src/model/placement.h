#pragma once

// Where a body's vertices are: its pose, applied to single vertices exactly as the contract says, and to boxes so that
// they hold all vertices of what they held before.

#include <cmath>
#include <limits>

#include "crumple/world.h"
#include "geometry/vec.h"

namespace crumple {

/// An axis-aligned box, closed. Bounds may be NaN where a pose overflows; such a box overlaps every box.
struct Bounds {
    Vec3d low, high;

    friend bool overlap(const Bounds& a, const Bounds& b) {
        return !(a.low.x > b.high.x || b.low.x > a.high.x || a.low.y > b.high.y || b.low.y > a.high.y ||
                 a.low.z > b.high.z || b.low.z > a.high.z);
    }
    void widen(const Vec3d& p) { low = min(low, p), high = max(high, p); }
    void widen(const Bounds& other) { low = min(low, other.low), high = max(high, other.high); }
};
inline constexpr double largest_number = std::numeric_limits<double>::max();
inline constexpr Bounds no_bounds{{largest_number, largest_number, largest_number},
                                  {-largest_number, -largest_number, -largest_number}};

class Placement {
   public:
    Placement() = default;
    /// `pose` null: as given. `float32`: the shape's precision.
    Placement(const Pose* pose, bool float32) : pose_(pose && *pose != Pose{} ? pose : nullptr), float32_(float32) {}

    bool identity() const { return pose_ == nullptr; }

    Vec3d operator()(const Vec3d& p) const {
        if (!pose_) return p;
        const auto along = [&](const double* r) { return ((r[0] * p.x + r[1] * p.y) + r[2] * p.z) + r[3]; };
        const Vec3d posed{along(row(0)), along(row(1)), along(row(2))};
        return float32_ ? rounded(posed) : posed;
    }

    /// Holds every posed vertex whose given position `box` holds. A vertex is c + d with |d| <= h by axis, c and h the
    /// box's middle and half extent; six roundings of float64, and one of the shape's precision, separate what is
    /// computed from what is true.
    Bounds operator()(const Bounds& box) const {
        if (!pose_) return box;
        const double u = float32_ ? 0x1p-22 : 0x1p-49, tiny = float32_ ? 0x1p-148 : 0x1p-1070;
        const Vec3d c = 0.5 * box.low + 0.5 * box.high, h = max(box.high - c, c - box.low);
        Bounds posed;
        for (int axis = 0; axis < 3; ++axis) {
            const double* r = row(axis);
            const double x = std::abs(r[0]), y = std::abs(r[1]), z = std::abs(r[2]);
            const double middle = ((r[0] * c.x + r[1] * c.y) + r[2] * c.z) + r[3];
            const double reach = (x * h.x + y * h.y) + z * h.z;
            const double size = reach + ((x * std::abs(c.x) + y * std::abs(c.y)) + z * std::abs(c.z)) + std::abs(r[3]);
            posed.low[axis] = middle - (reach + (u * size + tiny));
            posed.high[axis] = middle + (reach + (u * size + tiny));
        }
        return posed;
    }

   private:
    // By way of memory, since g++ 12 with -O3 takes double(float(x)) for x where it selects between both in lanes.
    static Vec3d rounded(const Vec3d& p) {
        volatile float x = static_cast<float>(p.x), y = static_cast<float>(p.y), z = static_cast<float>(p.z);
        return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    }

    const double* row(int axis) const { return pose_->rows.data() + 4 * axis; }

    const Pose* pose_ = nullptr;
    bool float32_ = true;
};

}  // namespace crumple
