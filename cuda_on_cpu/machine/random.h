#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace cuda_on_cpu {

/// Marsaglia's 64-bit xorshift, for rubbish in fresh memory and choices of random orders. Deterministic for a seed.
class Random {
   public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 0xD1B54A32D192ED03u) { next(); }

    std::uint64_t next() {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 7;
        state_ ^= state_ << 17;
        return state_;
    }
    /// Returns a number below `n`, which must be at least 1.
    std::uint64_t below(std::uint64_t n) { return next() % n; }

    void fill(void* memory, std::size_t bytes) {
        auto* at = static_cast<unsigned char*>(memory);
        for (; bytes >= 8; bytes -= 8, at += 8) {
            const std::uint64_t rubbish = next();
            std::memcpy(at, &rubbish, 8);
        }
        for (std::uint64_t rubbish = next(); bytes; --bytes, rubbish >>= 8) *at++ = static_cast<unsigned char>(rubbish);
    }

   private:
    std::uint64_t state_;
};

}  // namespace cuda_on_cpu
