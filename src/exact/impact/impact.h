#pragma once

// Input and result of the decision when two moving features first touch.

#include "geometry/vec.h"

namespace crumple {

/// Point on a straight trajectory: exactly start + t (end − start), t in [0, 1], of these float64 numbers.
struct MovingPoint {
    Vec3d start, end;
};

struct Impact {
    bool meets = false;  ///< true if the features have a point in common at some t in [0, 1]
    double toi = 0;      ///< the first such t, rounded down to float64: toi <= exact < next number; 0 without one
    bool start = false;  ///< true if this t is exactly 0: they touch at the start

    friend bool operator==(const Impact&, const Impact&) = default;
};

}  // namespace crumple
