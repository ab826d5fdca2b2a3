#pragma once

// Block of CUDA threads. Each thread is a fiber. One runs at a time, until it meets others.
//
// A meeting is any operation for which CUDA makes threads wait for one another: a barrier, a ballot, a shuffle, the
// inside of a CUB primitive. Each thread that arrives passes a pointer to its contribution and sleeps; the last one
// combines all contributions, then all may continue. `Order` (settings.h) chooses which thread continues first: that of
// the lowest rank, of the highest, or any. So in forward order warp 0 gets as far as it can before warp 1 starts.
//
// Errors are a meeting that can never be complete (threads wait in different places, or have exited), and a warp
// meeting whose mask lacks the caller, names threads that do not exist, or differs from the masks of others. The call
// site belongs to the meeting: two threads at two different __syncthreads() do not meet. Since compute capability 7.0
// CUDA lets threads that have exited miss a barrier; here that is an error, because CUB's primitives do not allow it.

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "cuda_on_cpu/machine/counts.h"
#include "cuda_on_cpu/machine/kernel.h"
#include "cuda_on_cpu/machine/random.h"
#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/settings.h"

namespace cuda_on_cpu {

inline constexpr unsigned warp_size = 32;
inline constexpr unsigned most_threads = 1024;

/// Call site of a meeting: function, file and line. Sites are equal if all members are.
struct Site {
    const char* what;
    const char* file;
    int line;
};

class Fiber;

class Block {
   public:
    /// Called by the last thread to arrive. contributions[i] is the pointer that thread i of the block, or lane i of
    /// the warp, passed; entries of lanes outside the mask are undefined.
    using Combine = void (*)(void* context, void* const* contributions);

    Block();
    ~Block();
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;

    /// Runs one block of the launch from begin to end, on the OS thread that constructed this object. `counts`: sums of
    /// the launch's work, null if it is not counted.
    void run(const Kernel& kernel, LaunchEdges& edges, uint3 index, LaunchCounts* counts);

    /// Returns the block whose thread runs on this OS thread; null on the host.
    static Block* running() { return last_ && last_->inside_ ? last_ : nullptr; }
    /// Returns the block whose thread runs on this OS thread. An error on the host.
    static Block& current() {
        if (!running()) fail("device code runs on the host, outside of a launch");
        return *last_;
    }

    /// Waits for all threads of the block. With `fence` the meeting is a barrier that orders memory.
    void meet(const Site& site, bool fence, void* contribution, Combine combine, void* context);
    /// Waits for the lanes of the caller's warp that `mask` names.
    void meet_in_warp(const Site& site, std::uint32_t mask, bool fence, void* contribution, Combine combine,
                      void* context);
    /// Lets other threads run first, as __nanosleep does.
    void yield();
    /// Orders memory within the block.
    void fence();

    uint3 index() const { return index_; }
    uint3 thread() const;
    /// Rank of the running thread in its block.
    unsigned rank() const { return rank_; }
    unsigned size() const { return size_; }
    /// Dynamic shared memory: `shared_bytes()` bytes that end at a guard page.
    std::byte* shared() const { return shared_; }
    std::size_t shared_bytes() const { return shared_bytes_; }
    /// Returns and increments the running thread's count of uses of CUB storage, so that each use touches another byte.
    unsigned next_use();
    Random& random() { return random_; }

    /// Note a step and an atomic of the running thread, if the launch is counted (counts.h).
    void note_step(const void* place) {
        if (counting_) counts_->step(rank_, place);
    }
    void note_atomic(const void* address, const char* file, int line);

    /// True if `address` lies in the guard page of the running thread's stack.
    bool in_stack_guard(const void* address) const;
    bool in_shared_guard(const void* address) const;

   private:
    struct Thread;
    struct Lane;
    struct Meeting;
    struct Warp;

    static Fiber& live(void* lane);
    void prepare_lanes(const Kernel& kernel);
    void prepare_shared();
    void check_shared() const;
    void note_meeting(unsigned warp, std::uint32_t lanes);
    unsigned pick();
    unsigned next_ready(unsigned rank) const;
    void wake_all();
    void wake_in_warp(unsigned warp, std::uint32_t lanes) {
        ready_[warp / 2] |= std::uint64_t{lanes} << warp % 2 * warp_size;
    }
    Fiber& next(bool ended);
    void pass_on(bool ended);
    void leave();
    void check_mask(const Site& site, std::uint32_t mask) const;
    Meeting& join(Warp& warp, const Site& site, std::uint32_t mask) const;
    [[noreturn]] void stuck() const;

    static constinit thread_local Block* last_;  ///< the block that ran last on this OS thread

    const Kernel* kernel_ = nullptr;
    LaunchEdges* edges_ = nullptr;
    uint3 index_{};
    unsigned size_ = 0, alive_ = 0, rank_ = 0;
    bool inside_ = false;
    bool counting_ = false;  ///< false inside meetings
    BlockCounts* counts_ = nullptr;
    Order order_ = Order::forward;

    Fiber* caller_ = nullptr;  ///< fiber that called run()
    Lane** fibers_ = nullptr;  ///< `fiber_count_` fibers, made so far
    unsigned fiber_count_ = 0, rotation_ = 0;
    Lane** lanes_ = nullptr;          ///< by rank (index of a thread in its block), of the current block
    void** contributions_ = nullptr;  ///< by rank
    Warp* warps_ = nullptr;
    Meeting* barrier_ = nullptr;
    std::uint64_t ready_[most_threads / 64] = {}, yielded_[most_threads / 64] = {};
    std::uint64_t spins_ = 0;
    double spin_began_ = 0;

    char fence_ = 0;
    std::byte* arena_ = nullptr;
    std::byte* shared_ = nullptr;
    std::size_t shared_bytes_ = 0;
    Random random_;
};

/// Orders memory across all threads of the device. To ThreadSanitizer a fence happens after every earlier fence, with
/// or without an atomic access in between. CUDA requires a fence on both sides of the atomic; a missing one is found.
void device_fence();

/// Typed view of the contributions to a meeting.
template <class T>
class Contributions {
   public:
    explicit Contributions(void* const* all) : all_(all) {}
    T& operator[](unsigned i) const { return *static_cast<T*>(all_[i]); }

   private:
    void* const* all_;
};

/// Waits for all threads of the block. The last one to arrive calls combine(contributions).
template <class T, class F>
void meet(const Site& site, bool fence, T& mine, F&& combine) {
    Block::current().meet(
        site, fence, &mine,
        [](void* f, void* const* all) { (*static_cast<std::remove_reference_t<F>*>(f))(Contributions<T>(all)); },
        &combine);
}
template <class T, class F>
void meet_in_warp(const Site& site, std::uint32_t mask, bool fence, T& mine, F&& combine) {
    Block::current().meet_in_warp(
        site, mask, fence, &mine,
        [](void* f, void* const* all) { (*static_cast<std::remove_reference_t<F>*>(f))(Contributions<T>(all)); },
        &combine);
}

}  // namespace cuda_on_cpu
