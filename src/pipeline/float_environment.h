#pragma once

// Round-to-nearest without flush-to-zero while it lives, whatever the caller had. Every public call and every task
// holds one: proofs of the filters and of the expansions assume that mode, and oneTBB's workers keep the mode in force
// when their arena was made.

#include <cstdint>

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace crumple {

class FloatEnvironment {
   public:
#if defined(__SSE2__) || defined(_M_X64)
    FloatEnvironment() : saved_(_mm_getcsr()) {
        if (saved_ & mode_bits) _mm_setcsr(saved_ & ~mode_bits);
    }
    ~FloatEnvironment() {
        if (saved_ & mode_bits) _mm_setcsr(saved_);
    }

   private:
    static constexpr std::uint32_t mode_bits =
        0x8000u | 0x6000u | 0x0040u;  // flush to zero, rounding, denormals are zero
    std::uint32_t saved_;
#elif defined(__aarch64__)
    FloatEnvironment() {
        asm volatile("mrs %0, fpcr" : "=r"(saved_));
        if (saved_ & mode_bits) asm volatile("msr fpcr, %0" ::"r"(saved_ & ~mode_bits));
    }
    ~FloatEnvironment() {
        if (saved_ & mode_bits) asm volatile("msr fpcr, %0" ::"r"(saved_));
    }

   private:
    static constexpr std::uint64_t mode_bits = (1ull << 24) | (3ull << 22);  // FZ, RMode
    std::uint64_t saved_;
#else
    FloatEnvironment() {
        std::fegetenv(&saved_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~FloatEnvironment() { std::fesetenv(&saved_); }

   private:
    std::fenv_t saved_;
#endif
   public:
    FloatEnvironment(const FloatEnvironment&) = delete;
    FloatEnvironment& operator=(const FloatEnvironment&) = delete;
};

}  // namespace crumple
