#pragma once

// Pairs of triangles that are hard to decide, from a seed: what the tests of this folder draw from.

#include <array>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <random>

#include "geometry/triangle.h"

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

enum class Kind {
    random,        ///< uniform in the unit cube
    random_float,  ///< the same, float32 numbers
    lattice,       ///< corners in {0, 1, 2, 3}^3: touching, coplanar, folded, degenerate
    flat,          ///< corners on one random plane but for rounding
    nudged,        ///< the lattice beside the origin, some coordinates moved by one unit in the last place
    huge,          ///< the lattice times 2^1022: differences overflow
    tiny,          ///< the lattice times the smallest subnormal
    mixed,         ///< each coordinate of its own magnitude, over the whole range of float64
    wide,          ///< the same, within the range of float32
};

/// How many pairs a test draws: fewer where rational arithmetic, the yardstick, is slow.
inline int rounds_of(Kind kind, int usual) {
    return kind == Kind::mixed ? 100 : kind == Kind::huge || kind == Kind::tiny ? 5'000 : usual;
}
inline constexpr std::array all_kinds{Kind::random, Kind::random_float, Kind::lattice, Kind::flat, Kind::nudged,
                                      Kind::huge,   Kind::tiny,         Kind::mixed,   Kind::wide};

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

    /// Two triangles of which some corners are the same vertex, some at equal positions, some repeated.
    TrianglePair operator()() {
        plane_ = {real(-2, 2), real(-2, 2), real(-1, 1)};
        TrianglePair pair{{{point(), point(), point()}, {0, 1, 2}}, {{point(), point(), point()}, {3, 4, 5}}};
        for (int shared = integer(4); shared > 0; --shared) copy(pair.a, integer(3), pair.b, integer(3), true);
        if (integer(8) == 0) copy(pair.a, integer(3), pair.b, integer(3), false);
        if (integer(16) == 0) copy(pair.a, integer(3), pair.a, integer(3), true);
        if (integer(16) == 0) copy(pair.b, integer(3), pair.b, integer(3), true);
        return pair;
    }

   private:
    double coordinate() {
        const double cell = integer(4);
        switch (kind_) {
            case Kind::random:
                return real(-1, 1);
            case Kind::random_float:
                return static_cast<float>(real(-1, 1));
            case Kind::lattice:
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
                return static_cast<float>(std::ldexp(real(-1, 1), integer(270) - 145));
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
