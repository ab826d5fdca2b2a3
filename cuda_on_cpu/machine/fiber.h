#pragma once

// Fiber: a thread of execution with a stack of its own, switched to and from explicitly, on Boost.Context. A fiber
// belongs to the OS thread that made it: thread-local variables keep their addresses across a switch.

#include <boost/context/fiber.hpp>
#include <boost/context/protected_fixedsize_stack.hpp>
#include <cstddef>

namespace cuda_on_cpu {

class Fiber {
   public:
    /// Bytes of stack, below which lies a guard page. Only pages that are touched use memory.
    static constexpr std::size_t stack_bytes = 256 << 10;

    /// Represents the calling OS thread, on its own stack.
    Fiber();
    /// Calls `body(argument)` when this fiber is first switched to. `body` must return the fiber to continue with.
    Fiber(Fiber& (*body)(void*), void* argument);
    Fiber(const Fiber&) = delete;
    Fiber& operator=(const Fiber&) = delete;
    /// The body must have returned, or never started.
    ~Fiber();

    /// Suspends this fiber, which must be the running one, and resumes `next`. Returns when another fiber switches
    /// back.
    void switch_to(Fiber& next);

    /// Returns the guard page at the end of the stack. An access to it is an overflow.
    const void* guard() const { return guard_; }

   private:
    void arrive(boost::context::fiber&& from);

    boost::context::fiber context_;  ///< point of suspension, while it does not run
    Fiber* from_ = nullptr;          ///< the fiber that switched to it last
    const void* guard_ = nullptr;
    const void* bottom_ = nullptr;  ///< lowest byte of the usable stack
    std::size_t usable_bytes_ = 0;
    void* fake_stack_ = nullptr;  ///< handle of AddressSanitizer
    void* thread_ = nullptr;      ///< handle of ThreadSanitizer
    bool owns_stack_ = false;
};

}  // namespace cuda_on_cpu
