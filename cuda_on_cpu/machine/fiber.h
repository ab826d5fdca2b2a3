#pragma once

// One thread of execution with a stack of its own, switched to and from by hand, on Boost.Context. A fiber belongs to
// the OS thread that made it: thread-local variables keep their addresses across a switch.

#include <boost/context/fiber.hpp>
#include <boost/context/protected_fixedsize_stack.hpp>
#include <cstddef>

namespace cuda_on_cpu {

class Fiber {
   public:
    /// Bytes of stack; below it lies a guard page. Only what is touched costs
    /// memory.
    static constexpr std::size_t stack_bytes = 256 << 10;

    /// `body(argument)` starts at the first resume(); it must call suspend() of this fiber to wait, and return to end.
    Fiber(void (*body)(void*), void* argument);
    Fiber(const Fiber&) = delete;
    Fiber& operator=(const Fiber&) = delete;
    /// The body must have returned, or never started.
    ~Fiber();

    /// Runs the body until it suspends or returns. Called from the OS thread's own stack.
    void resume();
    /// Goes back to whoever resumed. Called by the body.
    void suspend();

    /// The pages at the stack's end, whose touch is an overflow.
    const void* guard() const { return guard_; }

   private:
    boost::context::fiber context_;  ///< the body while it is suspended
    boost::context::fiber resumer_;  ///< whoever resumed, while it runs
    const void* guard_ = nullptr;
    const void* bottom_ = nullptr;  ///< lowest byte of the usable stack
    std::size_t usable_bytes_ = 0;
    void* own_fake_stack_ = nullptr;  ///< AddressSanitizer's
    void* resumer_fake_stack_ = nullptr;
    const void* resumer_bottom_ = nullptr;
    std::size_t resumer_bytes_ = 0;
    void* own_thread_ = nullptr;  ///< ThreadSanitizer's
    void* resumer_thread_ = nullptr;
};

}  // namespace cuda_on_cpu
