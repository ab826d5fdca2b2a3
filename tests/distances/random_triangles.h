#pragma once

// Random triangles with small integers as coordinates (lattices), of which many are degenerate or have equal distances,
// and with random float64 numbers (Lattice::fine).

#include <gtest/gtest.h>

#include <random>

#include "exact/distance/triangle_features.h"

namespace crumple::test {

enum class Lattice { tiny, small, plane, fine };
inline constexpr std::array all_lattices{Lattice::tiny, Lattice::small, Lattice::plane, Lattice::fine};

class RandomTriangles {
   public:
    RandomTriangles(Lattice lattice, unsigned seed) : lattice_(lattice), engine_(seed) {}

    /// Returns a random triangle, moved by `apart` along x.
    TrianglePoints operator()(double apart) { return {position(apart), position(apart), position(apart)}; }

    int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }

   private:
    Vec3d position(double apart) {
        if (lattice_ == Lattice::fine) {
            const auto number = [&] { return static_cast<double>(engine_()) * 0x1p-31 - 1; };
            return {number() + apart, number(), number()};
        }
        const int extent = lattice_ == Lattice::tiny ? 1 : 3;
        const auto number = [&] { return static_cast<double>(below(2 * extent + 1) - extent); };
        Vec3d p{number() + apart, number(), number()};
        if (lattice_ == Lattice::plane) p.z = 0;
        return p;
    }

    Lattice lattice_;
    std::mt19937 engine_;
};

/// Calls check(random, apart) `rounds` times for each lattice. `apart` is 0, 2.5 or 5.
template <class Check>
void for_triangles(unsigned rounds, Check check) {
    for (const Lattice lattice : all_lattices) {
        for (unsigned seed = 0; seed < rounds; ++seed) {
            RandomTriangles random(lattice, seed);
            SCOPED_TRACE(testing::Message() << "lattice " << static_cast<int>(lattice) << ", seed " << seed);
            check(random, random.below(3) * 2.5);
            if (testing::Test::HasFatalFailure()) return;
        }
    }
}

}  // namespace crumple::test
