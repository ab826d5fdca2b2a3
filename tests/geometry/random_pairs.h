#pragma once

// Random pairs of triangles that are hard to decide, drawn from a seed.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <random>

#include "geometry/triangle.h"
#include "rounds.h"

namespace crumple {

inline std::ostream& operator<<(std::ostream& out, const Triangle& t) {
    const auto precision = out.precision(17);
    for (std::size_t i = 0; i < 3; ++i) {
        out << (i ? " " : "") << '#' << t.vertex[i] << " (" << t.point[i].x << ", " << t.point[i].y << ", "
            << t.point[i].z << ')';
    }
    out.precision(precision);
    return out;
}

struct TrianglePair {
    Triangle a, b;
    friend std::ostream& operator<<(std::ostream& out, const TrianglePair& p) { return out << p.a << " | " << p.b; }
};

/// Rounds to float32. Not inlined: where g++ 12 vectorises double to float to double, the rounding is lost.
__attribute__((noinline)) inline float rounded(double x) { return static_cast<float>(x); }

enum class Kind {
    random,             ///< uniform in [-1, 1]^3
    random_float,       ///< uniform in [-1, 1]^3, float32 numbers
    lattice,            ///< corners in {0, 1, 2, 3}^3: touching, coplanar, folded, degenerate
    flat,               ///< corners on one random plane up to rounding
    nudged,             ///< corners in {1, 2, 3, 4}^3, a quarter of the coordinates moved by one unit in the last place
    huge,               ///< corners in {-3, -1, 1, 3}^3 times 2^1022: differences overflow
    tiny,               ///< corners in {-1, 0, 1, 2}^3 times the smallest subnormal
    mixed,              ///< each coordinate of its own magnitude, over the whole range of float64
    wide,               ///< each coordinate of its own magnitude, within the range of float32
    collapsed,          ///< float32 numbers, one or both triangles degenerate: segments and points
    collapsed_lattice,  ///< lattice corners, one or both triangles degenerate
    threaded,           ///< small integers, a degenerate triangle through a point at which it may touch the other
};

/// Returns the number of pairs that a test draws: fewer where rational arithmetic, the reference, is slow.
inline int rounds_of(Kind kind, int usual) {
    return scaled_rounds(kind == Kind::mixed ? 100 : kind == Kind::huge || kind == Kind::tiny ? usual / 4 : usual);
}
inline constexpr std::array all_kinds{Kind::random,
                                      Kind::random_float,
                                      Kind::lattice,
                                      Kind::flat,
                                      Kind::nudged,
                                      Kind::huge,
                                      Kind::tiny,
                                      Kind::mixed,
                                      Kind::wide,
                                      Kind::collapsed,
                                      Kind::collapsed_lattice,
                                      Kind::threaded};

class RandomPairs {
   public:
    RandomPairs(Kind kind, std::uint64_t seed) : kind_(kind), engine_(seed) {}

    int integer(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }
    double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }

    Vec3d point() {
        if (kind_ == Kind::flat) {
            const double x = real(-1, 1), y = real(-1, 1);
            return {x, y, plane_.x * x + plane_.y * y + plane_.z};
        }
        return {coordinate(), coordinate(), coordinate()};
    }

    /// Returns two triangles that may share vertices, have corners at equal positions, or repeat corners.
    TrianglePair operator()() {
        if (kind_ == Kind::threaded) return threaded();
        plane_ = {real(-2, 2), real(-2, 2), real(-1, 1)};
        TrianglePair pair{{{point(), point(), point()}, {0, 1, 2}}, {{point(), point(), point()}, {3, 4, 5}}};
        for (int shared = integer(4); shared > 0; --shared) copy(pair.a, integer(3), pair.b, integer(3), true);
        if (integer(8) == 0) copy(pair.a, integer(3), pair.b, integer(3), false);
        if (integer(16) == 0) copy(pair.a, integer(3), pair.a, integer(3), true);
        if (integer(16) == 0) copy(pair.b, integer(3), pair.b, integer(3), true);
        if (kind_ == Kind::collapsed || kind_ == Kind::collapsed_lattice) {
            const int which = integer(3);
            if (which != 0) collapse(pair.a, 10);
            if (which != 1) collapse(pair.b, 20);
        }
        return pair;
    }

   private:
    /// Moves a corner onto the line of the other two: between them, beyond them, or onto one of them, with the same
    /// vertex id or another one. Sometimes all corners become one point. Exact for float32 numbers.
    void collapse(Triangle& t, std::int32_t fresh_vertex) {
        const auto moved = static_cast<std::size_t>(integer(3)), p = (moved + 1) % 3, q = (moved + 2) % 3;
        if (integer(8) == 0) t.point[q] = t.point[p], t.vertex[q] = integer(2) ? t.vertex[p] : fresh_vertex++;
        constexpr std::array along{0.0, 0.5, 2.0, -1.0};
        const auto choice = static_cast<std::size_t>(integer(4));
        t.point[moved] = t.point[p] + along[choice] * (t.point[q] - t.point[p]);
        t.vertex[moved] = choice == 0 && integer(2) ? t.vertex[p] : fresh_vertex;
    }

    Vec3d step() { return {integer(7) - 3.0, integer(7) - 3.0, integer(7) - 3.0}; }

    /// Returns a triangle and a degenerate one, whose corners lie on a line or at one point. The line passes through a
    /// grid point in the first triangle's plane: inside that triangle, on an edge, at a corner or outside. It may also
    /// lie in the plane.
    TrianglePair threaded() {
        const Vec3d o = step(), u = step(), v = integer(8) ? step() : (integer(5) - 2.0) * u;
        TrianglePair pair{{{o, o + 6.0 * u, o + 6.0 * v}, {0, 1, 2}}, {{}, {3, 4, 5}}};
        const Vec3d through = o + (integer(9) - 1.0) * u + (integer(9) - 1.0) * v;
        const Vec3d along = integer(3) == 0   ? step()
                            : integer(2) == 0 ? (integer(5) - 2.0) * u + (integer(5) - 2.0) * v
                                              : Vec3d{integer(3) - 1.0, integer(3) - 1.0, integer(3) - 1.0};
        const bool share = integer(2) == 0;
        for (std::size_t i = 0; i < 3; ++i) {
            pair.b.point[i] = through + (integer(7) - 3.0) * along;
            for (std::size_t j = 0; j < 3; ++j) {
                if (share && pair.b.point[i] == pair.a.point[j]) pair.b.vertex[i] = pair.a.vertex[j];
            }
        }
        return pair;
    }

    double coordinate() {
        const double cell = integer(4);
        switch (kind_) {
            case Kind::random:
                return real(-1, 1);
            case Kind::random_float:
            case Kind::collapsed:
                return rounded(real(-1, 1));
            case Kind::lattice:
            case Kind::collapsed_lattice:
            case Kind::threaded:
                return cell;
            case Kind::nudged:
                return integer(4) ? cell + 1 : std::nextafter(cell + 1, integer(2) ? 10 : 0);
            case Kind::huge:
                return (cell - 1.5) * 0x1p1023;
            case Kind::tiny:
                return (cell - 1) * 0x1p-1074;
            case Kind::mixed:
                return std::ldexp(real(-1, 1), integer(2090) - 1070);
            case Kind::wide:
                return rounded(std::ldexp(real(-1, 1), integer(270) - 145));
            case Kind::flat:
                break;
        }
        return 0;
    }
    static void copy(const Triangle& from, int i, Triangle& to, int j, bool same_vertex) {
        const auto source = static_cast<std::size_t>(i), target = static_cast<std::size_t>(j);
        to.point[target] = from.point[source];
        to.vertex[target] = same_vertex ? from.vertex[source] : 6;
    }

    Kind kind_;
    std::mt19937_64 engine_;
    Vec3d plane_;
};

}  // namespace crumple
