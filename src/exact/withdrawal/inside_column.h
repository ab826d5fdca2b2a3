#pragma once

// Parts of a line along a direction that lie inside bodies, in rational arithmetic. Host only.
//
// A column is a line along the direction, at a place p, or infinitely close to it: at p + e · w, e → 0+, for a
// direction w that is parallel to no edge at p. A body's inside, where its winding number is not 0, meets a column in
// open intervals of heights. So if bodies a and b have the inside intervals (l, h) and (l', h') in one column, their
// insides overlap if b is lifted by any number between l − h' and h − l'.

#include <span>
#include <vector>

#include "exact/withdrawal/sheared_face.h"

namespace crumple {

using FacesOfColumn = std::span<const ShearedFace* const>;

/// Open interval of heights; the winding number is not 0 except at single heights.
struct InsideInterval {
    Rational low, high;
    const ShearedFace *bottom, *top;  ///< faces at its ends, each one of possibly several
};

/// Open interval of the lifts of b at which the insides of a and b overlap in a column.
struct LiftInterval {
    Rational low, high;
    const ShearedFace *top_of_a, *bottom_of_b;  ///< faces that touch at the greatest lift
};

/// Returns the inside intervals at p + e · w of the body with these faces, from the lowest. `faces`: those of the body
/// that contain the column and are not upright; others do no harm.
std::vector<InsideInterval> insides_next_to(FacesOfColumn faces, const ShearedPlace& p, const ShearedPlace& w);

/// Returns the lifts for all pairs of an interval of a and one of b.
std::vector<LiftInterval> lifts_next_to(FacesOfColumn a, FacesOfColumn b, const ShearedPlace& p, const ShearedPlace& w);

/// Returns a direction in each sector around p. Within a sector, no face ends and no two faces that meet at p, with b
/// lifted by `lift`, change their order.
std::vector<ShearedPlace> sectors_around(FacesOfColumn a, FacesOfColumn b, const Rational& lift, const ShearedPlace& p);

/// True if the insides of a and of b, lifted by `lift`, overlap at p + e · w for all small e > 0. The overlap may be
/// infinitely short. `w`: one of sectors_around().
bool overlap_next_to(FacesOfColumn a, FacesOfColumn b, const Rational& lift, const ShearedPlace& p,
                     const ShearedPlace& w);

}  // namespace crumple
