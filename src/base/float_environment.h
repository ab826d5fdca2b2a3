#pragma once

// Floating-point mode for the lifetime of an object: round-to-nearest, whatever mode the caller had.
//
// FloatEnvironment keeps subnormal numbers. Every public call and every task holds one: exact decisions need that mode,
// and oneTBB's workers keep the mode that was in force when their arena was made.
//
// FlushToZero treats subnormal operands and results as zero. Filters hold one: an operation on a subnormal number may
// take 150 cycles, and scenes of cloth that comes to rest contain many such numbers. The error bounds of the filters
// allow for the flushing (docs/narrow.md).

#include <cstdint>

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#elif !defined(__aarch64__)
#include <cfenv>
#endif

namespace crumple {

#if defined(__SSE2__) || defined(_M_X64) || defined(__aarch64__)

template <bool flush>
class FloatMode {
   public:
    FloatMode() : saved_(get()) {
        if ((saved_ & mode) != wanted) set((saved_ & ~mode) | wanted);
    }
    ~FloatMode() {
        if ((saved_ & mode) != wanted) set(saved_);
    }
    FloatMode(const FloatMode&) = delete;
    FloatMode& operator=(const FloatMode&) = delete;

   private:
#if defined(__aarch64__)
    using Register = std::uint64_t;
    static constexpr Register rounding = 3ull << 22, flushing = 1ull << 24;
    static Register get() {
        Register value;
        asm volatile("mrs %0, fpcr" : "=r"(value));
        return value;
    }
    static void set(Register value) { asm volatile("msr fpcr, %0" ::"r"(value)); }
#else
    using Register = std::uint32_t;
    static constexpr Register rounding = 0x6000u, flushing = 0x8000u | 0x0040u;  // results (FTZ), operands (DAZ)
    static Register get() { return _mm_getcsr(); }
    static void set(Register value) { _mm_setcsr(value); }
#endif
    static constexpr Register mode = rounding | flushing, wanted = flush ? flushing : 0;

    Register saved_;
};

#else

// There is no portable way to flush subnormal numbers to zero, and none is needed: flushing only saves time. So both
// values of the parameter set the default environment.
template <bool>
class FloatMode {
   public:
    FloatMode() {
        std::fegetenv(&saved_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~FloatMode() { std::fesetenv(&saved_); }
    FloatMode(const FloatMode&) = delete;
    FloatMode& operator=(const FloatMode&) = delete;

   private:
    std::fenv_t saved_;
};

#endif

using FloatEnvironment = FloatMode<false>;
using FlushToZero = FloatMode<true>;

}  // namespace crumple
