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

    /// The calling OS thread itself, on its own stack.
    Fiber();
    /// `body(argument)` starts when this fiber is first switched to, and must end by returning the fiber to go on with.
    Fiber(Fiber& (*body)(void*), void* argument);
    Fiber(const Fiber&) = delete;
    Fiber& operator=(const Fiber&) = delete;
    /// The body must have returned, or never started.
    ~Fiber();

    /// Stops this fiber, which must be the running one, and goes on with `next`; returns when another switches back.
    void switch_to(Fiber& next);

    /// The pages at the stack's end, whose touch is an overflow.
    const void* guard() const { return guard_; }

   private:
    void arrive(boost::context::fiber&& from);

    boost::context::fiber context_;  ///< where it stopped, while it does not run
    Fiber* from_ = nullptr;          ///< the fiber that switched to it last
    const void* guard_ = nullptr;
    const void* bottom_ = nullptr;  ///< lowest byte of the usable stack
    std::size_t usable_bytes_ = 0;
    void* fake_stack_ = nullptr;  ///< AddressSanitizer's
    void* thread_ = nullptr;      ///< ThreadSanitizer's
    bool owns_stack_ = false;
};

}  // namespace cuda_on_cpu
