#pragma once

// Bound on the translation that separates two solids, from the volume of their overlap. Host only.

#include <algorithm>
#include <cmath>
#include <limits>

#include "exact/overlap/face_crossing.h"
#include "geometry/double_word.h"

namespace crumple {

/// Upper bound of the area of a surface's projection, whatever its direction: |(Σ |N_x|, Σ |N_y|, Σ |N_z|)| / 4 over
/// the faces, where |N| is twice the area of a face. At most half of the surface's area. The surface must be closed.
class ProjectedArea {
   public:
    /// Adds a face, the next one in the order of the surface. About 10 ns.
    void add(const FaceCorners& p) {
        const Vec3d u = p[1] - p[0], v = p[2] - p[0];
        const Vec3d normal{component(u.y, v.z, u.z, v.y), component(u.z, v.x, u.x, v.z), component(u.x, v.y, u.y, v.x)};
        for (int axis = 0; axis < 3; ++axis) sum_[axis] = sum_[axis] + DoubleWord{normal[axis], 0};
    }
    /// Returns the bound, rounded up; infinity or NaN if a number overflows.
    double bound() const { return (1 + 0x1p-48) * std::hypot(sum_.x.high, sum_.y.high, sum_.z.high) / 4; }

   private:
    /// Returns a float64 that is at least the magnitude of a cross product's component, x y' − x' y. Each difference of
    /// coordinates has a relative error of 2^-53, each product one of 3.01 · 2^-53, and subnormal numbers add a little.
    static double component(double x, double other_y, double other_x, double y) {
        const double first = x * other_y, second = other_x * y;
        return std::abs(first - second) + 0x1p-50 * (std::abs(first) + std::abs(second)) + 0x1p-1070;
    }

    Vec3<DoubleWord> sum_{{0, 0}, {0, 0}, {0, 0}};
};

/// Returns a lower bound on the length of each path of translations from the place of a body to one where it does not
/// overlap another body, in the units of the coordinates: |volume| / min(area_a, area_b), rounded down by about 10^-13
/// of itself. `volume`: that of the overlap, rounded to nearest. `area_a`, `area_b`: ProjectedArea::bound(). Holds for
/// bodies whose winding numbers are 0 and 1 only, or 0 and −1 only. Returns 0 if the areas exceed all float64 numbers.
inline double least_translation(double area_a, double area_b, double volume) {
    if (!std::isfinite(area_a) || !std::isfinite(area_b)) return 0;
    constexpr double largest = std::numeric_limits<double>::max();
    const double least = std::min(area_a, area_b), magnitude = std::min(std::abs(volume), largest);
    // A subnormal volume may have been rounded up by a large part of itself.
    if (!(magnitude >= 0x1p-1000) || !(least > 0)) return 0;
    return std::min((1 - 0x1p-48) * (magnitude / least), largest);
}

}  // namespace crumple
