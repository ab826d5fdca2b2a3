#include "cuda_on_cpu/machine/fiber.h"

#include <unistd.h>

#include <utility>

#include "cuda_on_cpu/machine/sanitizers.h"

namespace cuda_on_cpu {

Fiber::Fiber() : thread_(current_thread()) {}

Fiber::Fiber(Fiber& (*body)(void*), void* argument) : thread_(new_thread()), owns_stack_(true) {
    boost::context::protected_fixedsize_stack stacks(stack_bytes);
    const boost::context::stack_context stack = stacks.allocate();
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    guard_ = static_cast<char*>(stack.sp) - stack.size;
    bottom_ = static_cast<const char*>(guard_) + page;
    usable_bytes_ = stack.size - page;
    context_ = boost::context::fiber(std::allocator_arg, boost::context::preallocated(stack.sp, stack.size, stack),
                                     stacks, [this, body, argument](boost::context::fiber&& from) {
                                         arrive(std::move(from));
                                         Fiber& next = body(argument);
                                         next.from_ = this;
                                         leave_stack(nullptr, next.bottom_, next.usable_bytes_);
                                         switch_thread(next.thread_);
                                         return std::move(next.context_);
                                     });
}

Fiber::~Fiber() {
    if (owns_stack_) end_thread(thread_);
}

void Fiber::switch_to(Fiber& next) {
    next.from_ = this;
    leave_stack(&fake_stack_, next.bottom_, next.usable_bytes_);
    switch_thread(next.thread_);
    arrive(std::move(next.context_).resume());
}

/// Stores the context and the stack bounds of the fiber that ran before. The stack bounds of an OS thread are available
/// only in this way.
void Fiber::arrive(boost::context::fiber&& from) {
    from_->context_ = std::move(from);
    arrive_on_stack(fake_stack_, &from_->bottom_, &from_->usable_bytes_);
}

}  // namespace cuda_on_cpu
