#pragma once

// The large shape of a square sheet that sinks over a ball: smooth, of the same form at every resolution.
//
// A profile (radius, height), drawn out by arc length from the sheet's centre, follows the ball to where contact ends,
// falls straight, turns to the floor and spreads. Turned about the axis it keeps lengths along the profile, not around
// it: where its radius falls short of the arc length there is too much cloth, and that goes into radial folds. A fold
// is a meander, a curve whose direction swings by an angle w about its course (Langbein and Leopold, 1966): it shortens
// cloth by J0(w), rises by J1(w) and swings aside by J2(w), overhangs once w passes 1.57 and meets the next fold
// at 2.2.

#include <vector>

#include "geometry/vec.h"
#include "scenes/random.h"

namespace crumple::scenes {

/// Shape of a sheet of half width 13, from flat on top of the ball (folded = 0) to gathered beneath it (1).
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
        double rise, swing;  // J1 and J2 of the meander that takes up the excess of cloth
    };
    Station at(double distance) const;

    std::vector<Station> stations_;
    double folded_;
    std::uint64_t seed_;
};

}  // namespace crumple::scenes
