#pragma once

// The mode of floating-point arithmetic while an object lives: round-to-nearest, whatever the caller had.
//
// FloatEnvironment keeps subnormal numbers. Every public call and every task holds one: the exact decision needs that
// mode, and oneTBB's workers keep the mode in force when their arena was made.
//
// FlushToZero takes them for zero, as operands and as results. The filters hold one: an operation on a subnormal number
// may take 150 cycles, and cloth at rest is full of them. The filters' bounds allow for it (docs/narrow.md).

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
    static constexpr Register rounding = 0x6000u, flushing = 0x8000u | 0x0040u;  // results, operands
    static Register get() { return _mm_getcsr(); }
    static void set(Register value) { _mm_setcsr(value); }
#endif
    static constexpr Register mode = rounding | flushing, wanted = flush ? flushing : 0;

    Register saved_;
};

#else

// Nothing portable flushes, nor is it needed.
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
