#pragma once

// Hash functions with a random seed, so that no mesh can be crafted to make hash tables slow: for positions (welding)
// and for integers. No result of a search depends on the seed. Compiled for host and device; the seed is drawn on the
// host.

#include <atomic>
#include <bit>
#include <cstdint>
#include <random>

#include "geometry/vec.h"

namespace crumple {

/// Hash function for a sequence of integers: starts from seed(), and is continued by add() for each integer.
class SeededHash {
   public:
    /// Makes a new seed. Draws a random number only once per process, because that takes 10 us on a virtual machine.
    /// The seeds of all objects differ nevertheless.
    SeededHash() {
        static std::atomic<std::uint64_t> last = [] {
            std::random_device random;
            return (std::uint64_t{random()} << 32) | random();
        }();
        seed_ = add(last.fetch_add(0x9e3779b97f4a7c15ull, std::memory_order_relaxed), 0);
    }
    CRUMPLE_HD std::uint64_t seed() const { return seed_; }

    /// Returns the hash h, continued by a value. Finaliser of MurmurHash3: every bit of the result depends on every bit
    /// of the argument.
    CRUMPLE_HD static std::uint64_t add(std::uint64_t h, std::uint64_t value) {
        h ^= value;
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdull;
        h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ull;
        return h ^ (h >> 33);
    }

   private:
    std::uint64_t seed_;
};

class PositionHash {
   public:
    CRUMPLE_HD std::uint64_t operator()(Vec3d p) const {
        std::uint64_t h = hash_.seed();
        for (int axis = 0; axis < 3; ++axis)
            h = SeededHash::add(h, std::bit_cast<std::uint64_t>(p[axis] + 0.0));  // -0 + 0 is +0
        return h;
    }

    /// Returns another hash, in fewer steps. -0 + 0 is +0.
    CRUMPLE_HD std::uint64_t operator()(Vec3f p) const {
        const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0f)}; };
        return SeededHash::add(SeededHash::add(hash_.seed(), bits(p.x) << 32 | bits(p.y)), bits(p.z));
    }

   private:
    SeededHash hash_;
};

}  // namespace crumple
