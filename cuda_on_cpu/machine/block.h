#pragma once

// A block of threads: each is a fiber, one runs at a time, and it runs until it meets others.
//
// A meeting is anything for which CUDA makes threads wait for one another: a barrier, a ballot, a shuffle, the inside
// of a CUB primitive. Each thread that comes hands in a pointer to its contribution and sleeps; the last one combines
// all contributions, then all may go on. Who goes on first is the order's choice (settings.h): a thread of the
// lowest rank, or the highest, or any. So in forward order warp 0 gets as far as it can before warp 1 starts.
//
// What is an error: a meeting that can never be complete (threads wait in different places, or have exited), a warp
// meeting whose mask lacks the caller, names threads that are not there, or differs from what others named. The call
// site belongs to the meeting: two threads at two different __syncthreads() do not meet. CUDA lets threads that have
// exited miss a barrier since compute capability 7.0; here they may not, because CUB's primitives do not allow it.

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "cuda_on_cpu/machine/kernel.h"
#include "cuda_on_cpu/machine/random.h"

namespace cuda_on_cpu {

inline constexpr unsigned warp_size = 32;
inline constexpr unsigned most_threads = 1024;

/// Which call threads meet in. Equal if all members are.
struct Site {
    const char* what;
    const char* file;
    int line;
};

class Fiber;

class Block {
   public:
    /// Called by the last thread to come. contributions[i] is what thread i of the block, or lane i of the warp, handed
    /// in; entries of lanes outside of the mask mean nothing.
    using Combine = void (*)(void* context, void* const* contributions);

    Block();
    ~Block();
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;

    /// Runs one block of the launch from begin to end, on the OS thread that made this object.
    void run(const Kernel& kernel, LaunchEdges& edges, uint3 index);

    /// The block whose thread runs on this OS thread, null on the host.
    static Block* running();
    /// The same; an error on the host.
    static Block& current();

    /// All threads of the block meet. `fence`: the meeting is a barrier that orders memory.
    void meet(const Site& site, bool fence, void* contribution, Combine combine, void* context);
    /// The lanes of the caller's warp that `mask` names meet.
    void meet_in_warp(const Site& site, std::uint32_t mask, bool fence, void* contribution, Combine combine,
                      void* context);
    /// Lets others go first, as __nanosleep does.
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
    /// Counts the running thread's uses of CUB storage, so that each use touches other bytes.
    unsigned next_use();
    Random& random() { return random_; }

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
    unsigned pick();
    unsigned next_ready(unsigned rank) const;
    void wake(unsigned rank) { ready_[rank / 64] |= std::uint64_t{1} << rank % 64; }
    Fiber& next(bool ended);
    void pass_on(bool ended);
    void leave();
    void check_mask(const Site& site, std::uint32_t mask) const;
    Meeting& join(Warp& warp, const Site& site, std::uint32_t mask) const;
    [[noreturn]] void stuck() const;

    const Kernel* kernel_ = nullptr;
    LaunchEdges* edges_ = nullptr;
    uint3 index_{};
    unsigned size_ = 0, alive_ = 0, rank_ = 0;
    bool inside_ = false;

    Fiber* caller_ = nullptr;  ///< of run()
    Lane** fibers_ = nullptr;  ///< all that were ever made
    unsigned fiber_count_ = 0, rotation_ = 0;
    Lane** lanes_ = nullptr;          ///< by rank, this run's
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

/// Orders memory of all threads. To ThreadSanitizer whoever fences later has seen what was written before an earlier
/// fence, with or without an atomic access in between: CUDA asks for a fence on both sides, and that is what is
/// checked.
void device_fence();

/// Contributions as what they are.
template <class T>
class Contributions {
   public:
    explicit Contributions(void* const* all) : all_(all) {}
    T& operator[](unsigned i) const { return *static_cast<T*>(all_[i]); }

   private:
    void* const* all_;
};

/// All threads of the block meet; combine(contributions) is called once.
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
