#pragma once

// When two moving features first touch: what the exact decision is given and what it answers.

#include "geometry/vec.h"

namespace crumple {

/// A point on its straight way: at start + t (end − start) for t in [0, 1], exactly, for these float64 numbers.
struct MovingPoint {
    Vec3d start, end;
};

struct Impact {
    bool meets = false;  ///< the closed sets have a point in common at some t in [0, 1]
    double toi = 0;      ///< the first such t, rounded down to float64: toi <= exact < next number; 0 without one
    bool start = false;  ///< it is 0 exactly: they touch at the start

    friend bool operator==(const Impact&, const Impact&) = default;
};

}  // namespace crumple
