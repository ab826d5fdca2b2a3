#pragma once

// Contact of two triangles: the extreme points of their exact intersection, correctly rounded.

#include <array>

#include "crumple/intersections.h"
#include "geometry/triangle.h"

namespace crumple {

struct Contact {
    // `points` precedes `count`, because nvcc 13.0 miscompiles copies of structs in which a size precedes its array
    // (docs/nvcc_13_0.md).
    std::array<Vec3d, 6> points;  ///< ordered as crumple::Contacts says
    int count = 0;                ///< 0: they do not intersect; otherwise 1, 2 or 3 to 6
    bool rational = false;        ///< true if it took rational arithmetic

    CRUMPLE_HD ContactKind kind() const { return static_cast<ContactKind>(count < 3 ? count : 3); }
};

/// Returns the whole intersection of two triangles, including parts that adjacent triangles share.
Contact contact(const Triangle& a, const Triangle& b);

}  // namespace crumple
