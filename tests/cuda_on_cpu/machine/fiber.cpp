#include "cuda_on_cpu/machine/fiber.h"

#include <unistd.h>

#include <utility>

#include "cuda_on_cpu/machine/sanitizers.h"

namespace cuda_on_cpu {
namespace {

// A switch without an edge: that one thread runs after another proves nothing about their accesses.
[[maybe_unused]] constexpr unsigned without_edge = 1;

}  // namespace

Fiber::Fiber(void (*body)(void*), void* argument) {
    boost::context::protected_fixedsize_stack stacks(stack_bytes);
    const boost::context::stack_context stack = stacks.allocate();
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    guard_ = static_cast<char*>(stack.sp) - stack.size;
    bottom_ = static_cast<const char*>(guard_) + page;
    usable_bytes_ = stack.size - page;
#ifdef CUDA_ON_CPU_TSAN
    own_thread_ = __tsan_create_fiber(0);
#endif
    context_ = boost::context::fiber(std::allocator_arg, boost::context::preallocated(stack.sp, stack.size, stack),
                                     stacks, [this, body, argument](boost::context::fiber&& resumer) {
                                         resumer_ = std::move(resumer);
#ifdef CUDA_ON_CPU_ASAN
                                         __sanitizer_finish_switch_fiber(nullptr, &resumer_bottom_, &resumer_bytes_);
#endif
                                         body(argument);
#ifdef CUDA_ON_CPU_ASAN
                                         __sanitizer_start_switch_fiber(nullptr, resumer_bottom_, resumer_bytes_);
#endif
#ifdef CUDA_ON_CPU_TSAN
                                         __tsan_switch_to_fiber(resumer_thread_, without_edge);
#endif
                                         return std::move(resumer_);
                                     });
}

Fiber::~Fiber() {
#ifdef CUDA_ON_CPU_TSAN
    __tsan_destroy_fiber(own_thread_);
#endif
}

void Fiber::resume() {
#ifdef CUDA_ON_CPU_ASAN
    __sanitizer_start_switch_fiber(&resumer_fake_stack_, bottom_, usable_bytes_);
#endif
#ifdef CUDA_ON_CPU_TSAN
    resumer_thread_ = __tsan_get_current_fiber();
    __tsan_switch_to_fiber(own_thread_, without_edge);
#endif
    context_ = std::move(context_).resume();
#ifdef CUDA_ON_CPU_ASAN
    __sanitizer_finish_switch_fiber(resumer_fake_stack_, nullptr, nullptr);
#endif
}

void Fiber::suspend() {
#ifdef CUDA_ON_CPU_ASAN
    __sanitizer_start_switch_fiber(&own_fake_stack_, resumer_bottom_, resumer_bytes_);
#endif
#ifdef CUDA_ON_CPU_TSAN
    __tsan_switch_to_fiber(resumer_thread_, without_edge);
#endif
    resumer_ = std::move(resumer_).resume();
#ifdef CUDA_ON_CPU_ASAN
    __sanitizer_finish_switch_fiber(own_fake_stack_, &resumer_bottom_, &resumer_bytes_);
#endif
}

}  // namespace cuda_on_cpu
