#pragma once

// Parts of a line along a direction that lie inside bodies, in rational arithmetic. Host only.
//
// A column is a line along the direction, at a place p, or infinitely close to it: at p + e · w, e → 0+, for a
// direction w that is parallel to no edge at p. A body's inside, where its winding number is not 0, meets a column in
// open intervals of heights. So if bodies a and b have the inside intervals (l, h) and (l', h') in one column, their
// insides overlap if b is lifted by any number between l − h' and h − l'.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "exact/withdrawal/sheared_face.h"

namespace crumple {

using FacesOfColumn = std::span<const ShearedFace* const>;

/// Open interval of the lifts of b at which the insides of a and b overlap in a column.
struct LiftInterval {
    Rational low, high;
    const ShearedFace *top_of_a, *bottom_of_b;  ///< faces that touch at the greatest lift, each one of possibly several
};

/// Columns at a place p and next to it.
class InsideColumns {
   public:
    /// `a`, `b`: the faces of both bodies whose closed projection contains p and that are not upright; they must
    /// outlive this object. `lift`: that of b.
    InsideColumns(const ShearedPlace& p, FacesOfColumn a, FacesOfColumn b, const Rational& lift);

    /// True if p lies inside the projections of all faces, so that the columns next to p cross the same faces.
    bool is_generic() const;

    /// Sector around p, in which no face ends.
    struct Sector {
        ShearedPlace from, to;               ///< directions of its sides, counter-clockwise; less than 180° apart
        std::vector<std::size_t> crossings;  ///< faces that its columns cross, from the lowest at p

        ShearedPlace middle() const { return from + to; }
    };
    /// Returns the sectors around p. Cost: O(k log k) for k faces, and the size of the result.
    std::vector<Sector> sectors() const;
    /// Returns a direction w in the sector such that the insides overlap at p + e · w for all small e > 0, if there is
    /// one. The overlap may be infinitely short.
    std::optional<ShearedPlace> overlap_in(const Sector& sector) const;
    /// Returns the lifts at which the insides overlap in the limit of columns of a sector at p.
    std::vector<LiftInterval> lifts_in(const Sector& sector) const;
    /// Returns the lifts at p, if is_generic().
    std::vector<LiftInterval> lifts() const;

   private:
    /// Face that the columns may cross, at p at this height.
    struct Crossing {
        const ShearedFace* face;
        std::size_t body;
        Rational height;          ///< with the lift of b
        std::array<int, 3> side;  ///< of p, as ShearedFace::side()
    };
    /// Open interval of heights; the winding number is not 0 except at single heights.
    struct InsideInterval {
        Rational low, high;
        const ShearedFace *bottom, *top;
    };

    /// Sides of the sector of a face, counter-clockwise; equal if it is the whole plane.
    static std::pair<ShearedPlace, ShearedPlace> sides(const Crossing& crossing);
    bool overlap_next_to(const Sector& sector, const ShearedPlace& w) const;
    std::vector<InsideInterval> insides(std::size_t body, const Sector& sector) const;

    ShearedPlace place_;
    Rational lift_;
    std::vector<Crossing> crossings_;  ///< from the lowest
};

}  // namespace crumple
