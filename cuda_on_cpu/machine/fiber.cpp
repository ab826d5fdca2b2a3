#include "cuda_on_cpu/machine/fiber.h"

#include <unistd.h>

#include <utility>

#include "cuda_on_cpu/machine/sanitizers.h"

namespace cuda_on_cpu {

Fiber::Fiber(void (*body)(void*), void* argument) : own_thread_(new_thread()) {
    boost::context::protected_fixedsize_stack stacks(stack_bytes);
    const boost::context::stack_context stack = stacks.allocate();
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    guard_ = static_cast<char*>(stack.sp) - stack.size;
    bottom_ = static_cast<const char*>(guard_) + page;
    usable_bytes_ = stack.size - page;
    context_ = boost::context::fiber(std::allocator_arg, boost::context::preallocated(stack.sp, stack.size, stack),
                                     stacks, [this, body, argument](boost::context::fiber&& resumer) {
                                         resumer_ = std::move(resumer);
                                         arrive_on_stack(nullptr, &resumer_bottom_, &resumer_bytes_);
                                         body(argument);
                                         leave_stack(nullptr, resumer_bottom_, resumer_bytes_);
                                         switch_thread(resumer_thread_);
                                         return std::move(resumer_);
                                     });
}

Fiber::~Fiber() { end_thread(own_thread_); }

void Fiber::resume() {
    leave_stack(&resumer_fake_stack_, bottom_, usable_bytes_);
    resumer_thread_ = current_thread();
    switch_thread(own_thread_);
    context_ = std::move(context_).resume();
    arrive_on_stack(resumer_fake_stack_, nullptr, nullptr);
}

void Fiber::suspend() {
    leave_stack(&own_fake_stack_, resumer_bottom_, resumer_bytes_);
    switch_thread(resumer_thread_);
    resumer_ = std::move(resumer_).resume();
    arrive_on_stack(own_fake_stack_, &resumer_bottom_, &resumer_bytes_);
}

}  // namespace cuda_on_cpu
