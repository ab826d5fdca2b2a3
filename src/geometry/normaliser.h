#pragma once

// Normalised coordinates: shifted, and scaled by powers of two to at most 1 in magnitude, for stages that only need
// approximations.
//
// An axis is shifted only if its interval lies on one side of 0 within a factor of two. The shift is then the end
// nearest to 0, which makes the difference exact (Sterbenz). Scaling by powers of two is exact except for underflow. So
// y = (x pre - shift) post, where `pre` and `post` are powers of two, differs from its exact value by at most 2^-1000,
// and y is a float32 number if x and the corners of the scene's box are. `pre` is not 1 only for extreme coordinates:
// it keeps differences of very large and of subnormal numbers representable. Compiled for host and device.

#include <math.h>  // ilogb and ldexp, for host and device

#include <limits>

#include "geometry/vec.h"

namespace crumple {

struct Normaliser {
    double pre = 1, post = 1;
    Vec3d shift;

    Normaliser() = default;
    CRUMPLE_HD Normaliser(Vec3d low, Vec3d high) {
        const double reach = max(largest(abs(low)), largest(abs(high)));
        if (reach == 0) return;
        const int exponent = ilogb(reach);
        pre = exponent > 1000 ? 0x1p-8 : exponent < -700 ? 0x1p300 : 1.0;
        double extent = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double l = low[axis] * pre, h = high[axis] * pre;
            if (l > 0 && h <= 2 * l) shift[axis] = l;
            if (h < 0 && l >= 2 * h) shift[axis] = h;
            extent = max(extent, max(std::abs(l - shift[axis]), std::abs(h - shift[axis])));
        }
        if (extent > 0) post = ldexp(1.0, min(-ilogb(extent) - 1, 1000));
    }
    CRUMPLE_HD Vec3d operator()(Vec3d x) const {
        return {(x.x * pre - shift.x) * post, (x.y * pre - shift.y) * post, (x.z * pre - shift.z) * post};
    }
    /// Converts a normalised point to the scene's coordinates, rounded, and limited to finite numbers: a coordinate
    /// that was rounded up to 1 in float32 may correspond to one beyond the largest float64.
    Vec3d inverse(Vec3d y) const {
        constexpr double most = std::numeric_limits<double>::max();
        Vec3d x;
        for (int axis = 0; axis < 3; ++axis) x[axis] = max(-most, min(most, (y[axis] / post + shift[axis]) / pre));
        return x;
    }
};

}  // namespace crumple
