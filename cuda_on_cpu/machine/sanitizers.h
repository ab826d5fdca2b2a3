#pragma once

// Annotations for the sanitizers, which do nothing in builds without them.
//
// ThreadSanitizer sees each CUDA thread as a thread of its own. A happens-before edge exists only where CUDA guarantees
// one: from launch to thread, at a barrier, from thread to the end of the launch. The machine's own bookkeeping is
// compiled without instrumentation; parts that must be inline in instrumented code are wrapped in `Untracked`.

#include <cstddef>

// In builds with AddressSanitizer, some files of the machine are compiled without its instrumentation. The build
// defines CUDA_ON_CPU_ASAN for them.
#if !defined(CUDA_ON_CPU_ASAN)
#if defined(__SANITIZE_ADDRESS__)
#define CUDA_ON_CPU_ASAN
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CUDA_ON_CPU_ASAN
#endif
#endif
#endif

#ifdef CUDA_ON_CPU_TSAN
#include <sanitizer/tsan_interface.h>
extern "C" {
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
void AnnotateIgnoreWritesBegin(const char* file, int line);
void AnnotateIgnoreWritesEnd(const char* file, int line);
}
#endif
#ifdef CUDA_ON_CPU_ASAN
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

namespace cuda_on_cpu {

#ifdef CUDA_ON_CPU_TSAN
inline constexpr bool thread_sanitizer = true;
inline void release_edge(void* object) { __tsan_release(object); }
inline void acquire_edge(void* object) { __tsan_acquire(object); }
// Threads of ThreadSanitizer, one for each fiber. A switch adds no edge: that one fiber runs after another does not
// order their memory accesses.
inline void* new_thread() { return __tsan_create_fiber(0); }
inline void* current_thread() { return __tsan_get_current_fiber(); }
inline void switch_thread(void* thread) { __tsan_switch_to_fiber(thread, __tsan_switch_to_fiber_no_sync); }
inline void end_thread(void* thread) { __tsan_destroy_fiber(thread); }
struct Untracked {
    Untracked() {
        AnnotateIgnoreReadsBegin(__FILE__, __LINE__);
        AnnotateIgnoreWritesBegin(__FILE__, __LINE__);
    }
    ~Untracked() {
        AnnotateIgnoreWritesEnd(__FILE__, __LINE__);
        AnnotateIgnoreReadsEnd(__FILE__, __LINE__);
    }
    Untracked(const Untracked&) = delete;
    Untracked& operator=(const Untracked&) = delete;
};
#else
inline constexpr bool thread_sanitizer = false;
inline void release_edge(void*) {}
inline void acquire_edge(void*) {}
inline void* new_thread() { return nullptr; }
inline void* current_thread() { return nullptr; }
inline void switch_thread(void*) {}
inline void end_thread(void*) {}
struct Untracked {
    Untracked() {}
    Untracked(const Untracked&) = delete;
    Untracked& operator=(const Untracked&) = delete;
};
#endif

#ifdef CUDA_ON_CPU_ASAN
inline constexpr bool address_sanitizer = true;
inline void forbid(void* memory, std::size_t bytes) { __asan_poison_memory_region(memory, bytes); }
inline void allow(void* memory, std::size_t bytes) { __asan_unpoison_memory_region(memory, bytes); }
// Announce a switch between stacks. leave_stack names the next stack and saves the state of the current one in `kept`
// (null if the fiber ends). arrive_on_stack restores that state and returns the bounds of the previous stack.
inline void leave_stack(void** kept, const void* to_bottom, std::size_t to_bytes) {
    __sanitizer_start_switch_fiber(kept, to_bottom, to_bytes);
}
inline void arrive_on_stack(void* kept, const void** from_bottom, std::size_t* from_bytes) {
    __sanitizer_finish_switch_fiber(kept, from_bottom, from_bytes);
}
#else
inline constexpr bool address_sanitizer = false;
inline void forbid(void*, std::size_t) {}
inline void allow(void*, std::size_t) {}
inline void leave_stack(void**, const void*, std::size_t) {}
inline void arrive_on_stack(void*, const void**, std::size_t*) {}
#endif

}  // namespace cuda_on_cpu
