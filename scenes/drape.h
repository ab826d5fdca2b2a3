#pragma once

// Shape of a square sheet that sinks over a ball, without wrinkles: smooth, and of the same form at every resolution.
//
// It is a surface of revolution with folds. Its profile is a curve (radius, height), parametrised by the arc length
// from the sheet's centre: it follows the ball to where contact ends, falls straight, turns to the floor and spreads.
// The surface of revolution preserves lengths along the profile, but not around the axis: where the radius is less than
// the arc length, there is too much cloth, which goes into radial folds. A fold is a meander, a curve whose direction
// oscillates about its course with an amplitude w in radians (Langbein and Leopold, 1966). J0(w) is the ratio of a
// meander's extent to its length; its height is proportional to J1(w), and its swing to the side to J2(w) (Bessel
// functions). A fold overhangs if w exceeds 1.57, and touches the next fold at 2.2.

#include <vector>

#include "geometry/vec.h"
#include "scenes/random.h"

namespace crumple::scenes {

/// Shape of a sheet of half width 13: from flat on top of the ball (`folded` is 0) to gathered beneath it (1).
class Drape {
   public:
    static constexpr double half_width = 13, floor = 0.2, ball_radius = 4;
    static constexpr Vec3d ball_centre{0, 0, 5.2};

    /// `clearance`: distance between ball and sheet.
    Drape(double folded, double clearance, std::uint64_t seed);

    /// Returns the position of the sheet's point (u, v); (0, 0) is its centre.
    Vec3d operator()(double u, double v) const;

   private:
    struct Station {
        double radius, height;
        double slope;        // in turns: 0 level, 1/4 straight down
        double rise, swing;  // J1(w) and J2(w) of the fold that takes up the excess of cloth
    };
    Station at(double distance) const;

    std::vector<Station> stations_;
    double folded_;
    std::uint64_t seed_;
};

}  // namespace crumple::scenes
