#pragma once

// Guard that sets a floating-point mode that a caller of the library may have set. `turn` modulo 4 selects the rounding
// mode; if turn & 4 is not 0, subnormal numbers are flushed to zero, too. The destructor restores the previous mode.

#include <array>
#include <cfenv>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace crumple {

class CallersMode {
   public:
    explicit CallersMode(int turn) {
        constexpr std::array modes{FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
        std::fegetenv(&saved_);
        std::fesetround(modes[static_cast<std::size_t>(turn) % modes.size()]);
#if defined(__SSE2__)
        if (turn & 4) _mm_setcsr(_mm_getcsr() | 0x8040u);  // flush to zero, denormals are zero
#endif
    }
    ~CallersMode() { std::fesetenv(&saved_); }
    CallersMode(const CallersMode&) = delete;
    CallersMode& operator=(const CallersMode&) = delete;

   private:
    std::fenv_t saved_;
};

}  // namespace crumple
