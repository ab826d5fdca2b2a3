#pragma once

// A hash of positions for welding, with a random seed, so that no mesh can be made to be slow. Results of welding do
// not depend on it. Compiled for host and device, but for the seed.

#include <bit>
#include <cstdint>
#include <random>

#include "geometry/vec.h"

namespace crumple {

class PositionHash {
   public:
    PositionHash() {
        std::random_device random;
        seed_ = (std::uint64_t{random()} << 32) | random();
    }
    CRUMPLE_HD std::uint64_t operator()(Vec3d p) const {
        std::uint64_t h = seed_;
        for (int axis = 0; axis < 3; ++axis) h = mix(h ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0));  // -0 + 0 is +0
        return h;
    }

   private:
    /// Finaliser of MurmurHash3: every bit of the result depends on every bit of the argument.
    CRUMPLE_HD static std::uint64_t mix(std::uint64_t h) {
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdull;
        h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ull;
        return h ^ (h >> 33);
    }
    std::uint64_t seed_;
};

}  // namespace crumple
