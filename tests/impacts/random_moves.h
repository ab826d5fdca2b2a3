#pragma once

// Random moves with small integers as coordinates, from a seed. The smaller the integers, the more moves are
// degenerate.

#include <cstdint>
#include <random>

#include "impacts/moves.h"

namespace crumple {

enum class Lattice {
    tiny,   ///< coordinates -1, 0, 1: every kind of degeneracy
    small,  ///< -3 to 3
    wide,   ///< -50 to 50: mostly in general position
    flat,   ///< -3 to 3, in the plane x + y + z = 0 at all times
    level,  ///< -3 to 3, at all times in a plane normal to an axis, which moves along the axis
    line,   ///< -4 to 4 on the line of (1, -1, 2) at all times
    focus,  ///< on that line at time 1/2 only, when normals vanish
};
inline constexpr std::array all_lattices{Lattice::tiny,  Lattice::small, Lattice::wide, Lattice::flat,
                                         Lattice::level, Lattice::line,  Lattice::focus};

class RandomMoves {
   public:
    RandomMoves(Lattice lattice, std::uint64_t seed) : lattice_(lattice), engine_(seed) {}

    Move operator()(Feature feature) {
        Move move{feature, {}};
        const int axis = lattice_ == Lattice::level ? below(3) : 0;
        for (MovingPoint& p : move.point) {
            if (lattice_ == Lattice::focus) {
                const Vec3d middle = on_line(), step = position();
                p = {middle - step, middle + step};
            } else {
                p = {position(), position()};
            }
            if (lattice_ == Lattice::level) {
                p.start[axis] = move.point[0].start[axis];
                p.end[axis] = move.point[0].end[axis];
            }
        }
        return move;
    }

    /// Returns a number from 0 to n - 1, the same on every machine.
    int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }

   private:
    Vec3d on_line() { return static_cast<double>(below(9) - 4) * Vec3d{1, -1, 2}; }

    Vec3d position() {
        if (lattice_ == Lattice::line) return on_line();
        const int extent = lattice_ == Lattice::tiny ? 1 : lattice_ == Lattice::wide ? 50 : 3;
        const auto number = [&] { return static_cast<double>(below(2 * extent + 1) - extent); };
        Vec3d p{number(), number(), number()};
        if (lattice_ == Lattice::flat) p.z = -p.x - p.y;
        return p;
    }

    Lattice lattice_;
    std::mt19937_64 engine_;
};

}  // namespace crumple
