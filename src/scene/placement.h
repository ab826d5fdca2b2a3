#pragma once

// Applies a body's pose: to vertices with exactly the operations that crumple/world.h defines (Pose), and to boxes so
// that the posed box contains all posed vertices.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "crumple/world.h"
#include "geometry/two.h"
#include "geometry/vec.h"

namespace crumple {

/// Closed axis-aligned box. Bounds may be NaN if a pose overflows; such a box overlaps every box.
struct Bounds {
    Vec3d low, high;

    // Without branches, because it is hard to predict which axis separates two boxes.
    friend bool overlap(const Bounds& a, const Bounds& b) {
        const bool x = (a.low.x > b.high.x) | (b.low.x > a.high.x), y = (a.low.y > b.high.y) | (b.low.y > a.high.y),
                   z = (a.low.z > b.high.z) | (b.low.z > a.high.z);
        return !(x | y | z);
    }
    void widen(const Vec3d& p) { low = min(low, p), high = max(high, p); }
    void widen(const Bounds& other) { low = min(low, other.low), high = max(high, other.high); }
};
inline constexpr double largest_number = std::numeric_limits<double>::max();
inline constexpr Bounds no_bounds{{largest_number, largest_number, largest_number},
                                  {-largest_number, -largest_number, -largest_number}};

/// Box by its middle and half of its extent. It contains the box that it is made from, because the half extent is
/// rounded up.
struct CentredBox {
    Vec3d middle, half;

    CentredBox() = default;
    explicit CentredBox(const Bounds& box) : middle(0.5 * box.low + 0.5 * box.high) {
        half = max(box.high - middle, middle - box.low);
        for (int axis = 0; axis < 3; ++axis) half[axis] += 0x1p-50 * half[axis] + 0x1p-1070;
    }
};

/// Affine map (A | t).
struct Affine {
    std::array<double, 12> rows;
    Vec3d operator()(const Vec3d& p) const {
        const auto along = [&](std::size_t i) {
            return ((rows[i] * p.x + rows[i + 1] * p.y) + rows[i + 2] * p.z) + rows[i + 3];
        };
        return {along(0), along(4), along(8)};
    }
    Vec3d column(int j) const {
        const auto k = static_cast<std::size_t>(j);
        return {rows[k], rows[4 + k], rows[8 + k]};
    }
};

class Placement {
   public:
    Placement() = default;
    /// `pose`: not owned; null: identity. `float32`: true if the shape has float32 coordinates, to which posed vertices
    /// are rounded.
    Placement(const Pose* pose, bool float32) : pose_(pose && *pose != Pose{} ? pose : nullptr), float32_(float32) {}

    bool identity() const { return pose_ == nullptr; }

    Vec3d operator()(const Vec3d& p) const {
        if (!pose_) return p;
        const auto along = [&](const double* r) { return ((r[0] * p.x + r[1] * p.y) + r[2] * p.z) + r[3]; };
        const Vec3d posed{along(row(0)), along(row(1)), along(row(2))};
        return float32_ ? rounded(posed) : posed;
    }

    /// Poses many vertices, in blocks of four: given[axis] and posed[axis] have 4 * `blocks` coordinates each.
    void operator()(const double* const given[3], std::int32_t blocks, double* const posed[3]) const {
        for (int axis = 0; axis < 3; ++axis) {
            double* const out = posed[axis];
            if (!pose_) {
                std::copy_n(given[axis], 4 * blocks, out);
                continue;
            }
            const double *const x = given[0], *const y = given[1], *const z = given[2];
            const double a = row(axis)[0], b = row(axis)[1], c = row(axis)[2], t = row(axis)[3];
            const auto along = [&](std::int32_t i) {
                return ((a * load_two(x + i) + b * load_two(y + i)) + c * load_two(z + i)) + t;
            };
            for (std::int32_t i = 0; i < 4 * blocks; i += 4) {
                Two low = along(i), high = along(i + 2);
                if (float32_) round_to_float(low, high);
                store_two(low, out + i);
                store_two(high, out + i + 2);
            }
        }
    }

    Affine matrix() const { return {pose_ ? pose_->rows : Pose{}.rows}; }

    /// Returns a bound on the rounding errors of the posed coordinates of any vertex that is in `box` before it is
    /// posed: six roundings in float64, and one in the shape's precision. The bound also covers a few further
    /// operations on `box`.
    double error(const CentredBox& box) const {
        const std::array<double, 12> r = matrix().rows;
        double size = 0;
        for (std::size_t i = 0; i < 12; i += 4) {
            double sum = std::abs(r[i + 3]);
            for (int j = 0; j < 3; ++j)
                sum += std::abs(r[i + static_cast<std::size_t>(j)]) * (std::abs(box.middle[j]) + box.half[j]);
            size = max(size, sum);
        }
        return float32_ ? 0x1p-21 * size + 0x1p-148 : 0x1p-46 * size + 0x1p-1070;
    }

    /// Returns a box that contains every posed vertex whose given position is in `box`.
    Bounds operator()(const CentredBox& box) const {
        const double e = error(box);
        const Affine p = matrix();
        Bounds posed;
        for (int axis = 0; axis < 3; ++axis) {
            const double* r = p.rows.data() + 4 * axis;
            const double middle = ((r[0] * box.middle.x + r[1] * box.middle.y) + r[2] * box.middle.z) + r[3];
            const double reach =
                (std::abs(r[0]) * box.half.x + std::abs(r[1]) * box.half.y) + std::abs(r[2]) * box.half.z + e;
            posed.low[axis] = middle - reach;
            posed.high[axis] = middle + reach;
        }
        return posed;
    }

   private:
    // Rounds to float32. Hides the rounded numbers from the optimiser, because g++ 12 with -O3 replaces
    // double(float(x)) by x where vectorised code selects between x and double(float(x)). The numbers go through memory
    // as one vector; loads of smaller pieces would stall.
    static void round_to_float(Two& low, Two& high) {
        using Four = float __attribute__((vector_size(16)));
        Four rounded{static_cast<float>(low[0]), static_cast<float>(low[1]), static_cast<float>(high[0]),
                     static_cast<float>(high[1])};
        asm("" : "+m"(rounded));
        low = Two{static_cast<double>(rounded[0]), static_cast<double>(rounded[1])};
        high = Two{static_cast<double>(rounded[2]), static_cast<double>(rounded[3])};
    }
    static Vec3d rounded(const Vec3d& p) {
        Two low{p.x, p.y}, high{p.z, 0};
        round_to_float(low, high);
        return {low[0], low[1], high[0]};
    }

    const double* row(int axis) const { return pose_->rows.data() + 4 * axis; }

    const Pose* pose_ = nullptr;
    bool float32_ = true;
};

}  // namespace crumple
