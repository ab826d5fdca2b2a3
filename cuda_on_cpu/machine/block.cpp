#include "cuda_on_cpu/machine/block.h"

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>
#include <utility>

#include "cuda_on_cpu/machine/device_limits.h"
#include "cuda_on_cpu/machine/fiber.h"
#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/sanitizers.h"
#include "cuda_on_cpu/machine/settings.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/thread_index.h"

// Scheduler of the threads of a block. It is one file because the choice of the next thread, the meetings and the
// checks read the same state.
//
// This file is compiled without ThreadSanitizer's instrumentation. State that several fibers share is therefore in
// plain arrays: the linker might choose another file's instrumented copy of a container's functions.

namespace cuda_on_cpu {
namespace {

constexpr std::size_t page = 4096;
constexpr std::size_t arena_bytes = (limits::shared_bytes_per_block_optin + page - 1) / page * page;
constexpr std::size_t shared_alignment = 16;
// Canary bytes in front of shared memory. Behind it, canaries fill the gap up to the guard page.
constexpr std::size_t canary_bytes = 64;
constexpr unsigned char canary = 0xC5;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

bool same(const char* a, const char* b) { return a == b || std::strcmp(a, b) == 0; }
/// Turns counting off for its lifetime.
class Uncounted {
   public:
    explicit Uncounted(bool& counting) : counting_(counting), before_(std::exchange(counting, false)) {}
    Uncounted(const Uncounted&) = delete;
    Uncounted& operator=(const Uncounted&) = delete;
    ~Uncounted() { counting_ = before_; }

   private:
    bool& counting_;
    bool before_;
};

bool same(const Site& a, const Site& b) { return a.line == b.line && same(a.what, b.what) && same(a.file, b.file); }

}  // namespace

/// State of one CUDA thread of the block, which has not started, runs, waits or has ended.
struct Block::Thread {
    uint3 index{};
    unsigned uses = 0;
    bool started = false, alive = false;
    const Site* waits_in = nullptr;
    std::uint32_t mask = 0;  // lanes of the meeting it waits in; 0: the whole block
};

/// Fiber, which is reused for every block, and the CUDA thread that it runs in the current block.
struct Block::Lane {
    Lane(Block* owner) : block(owner), fiber(&Block::live, this) {}
    Block* block;
    Fiber fiber;
    Thread thread;
    bool quit = false;
};

/// Group of threads that wait for one another: a whole block, or the lanes of a mask. ThreadSanitizer's happens-before
/// edges alternate between two objects, so that a thread that is slow to leave one meeting does not acquire the edges
/// of threads that have already arrived at the next.
struct Block::Meeting {
    Site site{};
    std::uint32_t mask = 0, arrived = 0;
    unsigned count = 0, phase = 0;
    char edges[2] = {};
};

/// Meetings of the lanes of a warp. Several may be in progress at a time; a lane waits in one of them at most.
struct Block::Warp {
    Meeting meetings[warp_size];
    std::uint32_t open = 0;    // bit i: meetings[i] is in progress
    std::uint32_t exited = 0;  // lanes that have exited or do not exist
};

constinit thread_local Block* Block::last_ = nullptr;

Block::Block() : random_(settings().seed) {
    void* pages = mmap(nullptr, arena_bytes + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) fail("the host has no memory left for a block");
    arena_ = static_cast<std::byte*>(pages);
    mprotect(arena_ + arena_bytes, page, PROT_NONE);
    lanes_ = new Lane*[most_threads];
    contributions_ = new void*[most_threads];
    caller_ = new Fiber;
    warps_ = new Warp[most_threads / warp_size];
    barrier_ = new Meeting;
    counts_ = new BlockCounts;
}

Block::~Block() {
    for (unsigned i = 0; i < fiber_count_; ++i) {
        fibers_[i]->quit = true;
        caller_->switch_to(fibers_[i]->fiber);
        delete fibers_[i];
    }
    delete caller_;
    delete[] fibers_;
    delete[] lanes_;
    delete[] contributions_;
    delete[] warps_;
    delete barrier_;
    delete counts_;
    allow(arena_, arena_bytes);
    munmap(arena_, arena_bytes + page);
}

uint3 Block::thread() const { return lanes_[rank_]->thread.index; }
unsigned Block::next_use() { return lanes_[rank_]->thread.uses++; }

void Block::run(const Kernel& kernel, LaunchEdges& edges, uint3 index, LaunchCounts* counts) {
    kernel_ = &kernel;
    edges_ = &edges;
    index_ = blockIdx = index;
    blockDim = kernel.block;
    gridDim = kernel.grid;
    size_ = kernel.block.x * kernel.block.y * kernel.block.z;
    shared_bytes_ = kernel.shared_bytes;
    order_ = settings().order;
    last_ = this;
    prepare_shared();
    prepare_lanes(kernel);
    if (counts) counts_->begin(*counts, size_);
    counting_ = counts != nullptr;
    caller_->switch_to(next(false));  // and back when no thread can run
    counting_ = false;
    if (alive_) stuck();
    if (counts) counts_->end();
    check_shared();
}

/// Assigns a fiber to each thread of the block. A thread gets another fiber than the thread of the same rank in the
/// previous block: to ThreadSanitizer a fiber is a thread, and accesses of one thread never race.
void Block::prepare_lanes(const Kernel& kernel) {
    const unsigned wanted = thread_sanitizer ? size_ + warp_size : size_;
    if (fiber_count_ < wanted) {
        auto** more = new Lane*[wanted];
        std::copy(fibers_, fibers_ + fiber_count_, more);
        for (; fiber_count_ < wanted; ++fiber_count_) more[fiber_count_] = new Lane(this);
        delete[] fibers_;
        fibers_ = more;
    }
    ++rotation_;
    for (unsigned rank = 0; rank < size_; ++rank) {
        lanes_[rank] = fibers_[(rank + rotation_) % fiber_count_];
        Thread& thread = lanes_[rank]->thread = {};
        thread.index = {rank % kernel.block.x, rank / kernel.block.x % kernel.block.y,
                        rank / (kernel.block.x * kernel.block.y)};
        thread.alive = true;
        contributions_[rank] = nullptr;
    }
    wake_all();
    for (unsigned w = 0; w * warp_size < size_; ++w) {
        // Lanes beyond the end of the block count as exited.
        const unsigned present = std::min(size_ - w * warp_size, warp_size);
        warps_[w].exited = present == warp_size ? 0 : ~0u << present;
        warps_[w].open = 0;
    }
    barrier_->count = 0;
    alive_ = size_;
    spins_ = 0;
}

void Block::prepare_shared() {
    const std::size_t whole = (shared_bytes_ + shared_alignment - 1) / shared_alignment * shared_alignment;
    shared_ = arena_ + arena_bytes - whole;
    allow(arena_, arena_bytes);
    if (thread_sanitizer) {
        // To ThreadSanitizer a new, untracked mapping is memory that no thread has touched, so accesses of the previous
        // block do not race with those of this one.
        const Untracked untracked;
        const std::size_t used = std::min(arena_bytes, (whole + canary_bytes + page - 1) / page * page);
        mmap(arena_ + arena_bytes - used, used, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    }
    auto* bytes = reinterpret_cast<unsigned char*>(shared_);
    random_.fill(bytes, shared_bytes_);
    for (std::size_t i = shared_bytes_; i < whole; ++i) bytes[i] = canary;
    if (whole + canary_bytes <= arena_bytes)
        for (std::size_t i = 1; i <= canary_bytes; ++i) *(bytes - i) = canary;
    forbid(arena_, static_cast<std::size_t>(shared_ - arena_));
    forbid(shared_ + shared_bytes_, whole - shared_bytes_);
}

void Block::check_shared() const {
    if (address_sanitizer) return;
    const auto* bytes = reinterpret_cast<const unsigned char*>(shared_);
    const auto* end = reinterpret_cast<const unsigned char*>(arena_ + arena_bytes);
    for (const unsigned char* p = bytes + shared_bytes_; p < end; ++p)
        if (*p != canary)
            fail("block (%u,%u,%u) wrote past its %zu bytes of shared memory", index_.x, index_.y, index_.z,
                 shared_bytes_);
    const auto before = std::min<std::size_t>(canary_bytes, static_cast<std::size_t>(shared_ - arena_));
    if (before < canary_bytes) return;
    for (std::size_t i = 1; i <= canary_bytes; ++i)
        if (*(bytes - i) != canary)
            fail("block (%u,%u,%u) wrote %zu bytes before its shared memory", index_.x, index_.y, index_.z, i);
}

void Block::wake_all() {
    unsigned warp = 0;
    for (; warp < size_ / warp_size; ++warp) wake_in_warp(warp, ~0u);
    if (size_ % warp_size) wake_in_warp(warp, (1u << size_ % warp_size) - 1);
}

/// Returns the first ready rank at or after `rank`, wrapping around. Requires that a thread is ready.
unsigned Block::next_ready(unsigned rank) const {
    const unsigned words = (size_ + 63) / 64;
    unsigned w = rank / 64;
    std::uint64_t here = ready_[w] & ~std::uint64_t{0} << rank % 64;
    while (!here) here = ready_[w = (w + 1) % words];
    return w * 64 + static_cast<unsigned>(std::countr_zero(here));
}

/// Removes the rank that runs next from the ready ones and returns it; returns `size_` if no thread can run.
unsigned Block::pick() {
    const unsigned words = (size_ + 63) / 64;
    bool any = false;
    for (unsigned w = 0; w < words; ++w) any |= ready_[w] != 0;
    if (!any) {
        for (unsigned w = 0; w < words; ++w) {
            any |= yielded_[w] != 0;
            ready_[w] = yielded_[w];
            yielded_[w] = 0;
        }
        if (!any) return size_;
        // Only spinning threads are left: they wait for another block, or for ever.
        if (spins_++ == 0) spin_began_ = now();
        std::this_thread::yield();
        if (spins_ % 256 == 0 && now() - spin_began_ > settings().spin_seconds) stuck();
    }
    unsigned rank = 0;
    switch (order_) {
        case Order::forward:
            for (unsigned w = 0;; ++w)
                if (ready_[w]) {
                    rank = w * 64 + static_cast<unsigned>(std::countr_zero(ready_[w]));
                    break;
                }
            break;
        case Order::reverse:
            for (unsigned w = words - 1;; --w)
                if (ready_[w]) {
                    rank = w * 64 + 63 - static_cast<unsigned>(std::countl_zero(ready_[w]));
                    break;
                }
            break;
        case Order::random:
            rank = next_ready(static_cast<unsigned>(random_.below(size_)));
            break;
    }
    ready_[rank / 64] &= ~(std::uint64_t{1} << rank % 64);
    return rank;
}

void Block::note_atomic(const void* address, const char* file, int line) {
    const auto* byte = static_cast<const std::byte*>(address);
    const bool shared = byte >= shared_ && byte < shared_ + shared_bytes_;
    if (counting_) counts_->atomic(rank_, address, shared, file, line);
}

/// Counts a meeting of the lanes of a warp. Lanes that have exited count as present, so that their last steps coincide
/// with those of the others.
void Block::note_meeting(unsigned warp, std::uint32_t lanes) {
    if (counting_) counts_->meet(warp, lanes | warps_[warp].exited);
}

/// Body of a fiber: runs one CUDA thread after another.
Fiber& Block::live(void* argument) {
    Lane& lane = *static_cast<Lane*>(argument);
    Block& block = *lane.block;
    while (!lane.quit) {
        acquire_edge(&block.edges_->begin);
        block.kernel_->body();
        release_edge(&block.edges_->end);
        block.leave();
        block.pass_on(true);
    }
    return *block.caller_;
}

/// Selects the thread that runs next and returns its fiber, or the fiber of run() if no thread can run. The fiber of a
/// thread that has just ended takes over a thread that has not started, which saves a switch.
Fiber& Block::next(bool ended) {
    const unsigned last = rank_;
    inside_ = false;
    rank_ = pick();
    if (rank_ == size_) return *caller_;
    // To ThreadSanitizer a fiber is a thread, so there each thread has its own.
    if (ended && !lanes_[rank_]->thread.started && !thread_sanitizer) {
        std::swap(lanes_[last]->thread, lanes_[rank_]->thread);
        std::swap(lanes_[last], lanes_[rank_]);
    }
    lanes_[rank_]->thread.started = true;
    threadIdx = lanes_[rank_]->thread.index;
    inside_ = true;
    return lanes_[rank_]->fiber;
}

/// Switches to the next thread. Returns when the calling fiber has a thread to run again.
void Block::pass_on(bool ended) {
    Fiber& mine = lanes_[rank_]->fiber;
    Fiber& other = next(ended);
    if (&other != &mine) mine.switch_to(other);
}

void Block::leave() {
    lanes_[rank_]->thread.alive = false;
    --alive_;
    spins_ = 0;
    Warp& warp = warps_[rank_ / warp_size];
    const std::uint32_t bit = 1u << rank_ % warp_size;
    warp.exited |= bit;
    if (barrier_->count)
        fail_in_kernel("exits while others wait for it in %s at %s:%d", barrier_->site.what, barrier_->site.file,
                       barrier_->site.line);
    for (std::uint32_t open = warp.open; open; open &= open - 1) {
        const Meeting& meeting = warp.meetings[std::countr_zero(open)];
        if (meeting.mask & bit)
            fail_in_kernel("exits while others wait for it in %s(0x%08x) at %s:%d", meeting.site.what, meeting.mask,
                           meeting.site.file, meeting.site.line);
    }
}

void Block::meet(const Site& site, bool fence, void* contribution, Combine combine, void* context) {
    Thread& me = lanes_[rank_]->thread;
    Meeting& meeting = *barrier_;
    if (alive_ < size_)
        fail_in_kernel("reaches %s at %s:%d, which %u threads that have exited will never reach", site.what, site.file,
                       site.line, size_ - alive_);
    if (meeting.count == 0) meeting.site = site;
    if (!same(meeting.site, site))
        fail_in_kernel("is in %s at %s:%d while others of its block wait in %s at %s:%d", site.what, site.file,
                       site.line, meeting.site.what, meeting.site.file, meeting.site.line);
    me.waits_in = &site;
    me.mask = 0;
    contributions_[rank_] = contribution;
    char* const edge = &meeting.edges[meeting.phase % 2];
    if (fence) release_edge(edge);
    if (++meeting.count == size_) {
        for (unsigned w = 0; w * warp_size < size_; ++w) note_meeting(w, ~0u);
        if (combine) {
            const Untracked untracked;
            const Uncounted uncounted(counting_);
            combine(context, contributions_);
        }
        meeting.count = 0;
        ++meeting.phase;
        spins_ = 0;
        wake_all();
    }
    pass_on(false);
    me.waits_in = nullptr;
    if (fence) acquire_edge(edge);
}

void Block::check_mask(const Site& site, std::uint32_t mask) const {
    const std::uint32_t exited = warps_[rank_ / warp_size].exited;
    if (!(mask >> rank_ % warp_size & 1))
        fail_in_kernel("%s(0x%08x) at %s:%d: the mask lacks the caller, lane %u", site.what, mask, site.file, site.line,
                       rank_ % warp_size);
    if (mask & exited)
        fail_in_kernel("%s(0x%08x) at %s:%d: the mask names lanes 0x%08x, which do not exist or have exited", site.what,
                       mask, site.file, site.line, mask & exited);
}

Block::Meeting& Block::join(Warp& warp, const Site& site, std::uint32_t mask) const {
    const std::uint32_t bit = 1u << rank_ % warp_size;
    for (std::uint32_t open = warp.open; open; open &= open - 1) {
        Meeting& meeting = warp.meetings[std::countr_zero(open)];
        if (meeting.mask == mask && same(meeting.site, site)) return meeting;
        // Lanes may wait for the caller in another meeting, unless the caller is about to wait for them.
        if (meeting.mask & bit && meeting.arrived & mask)
            fail_in_kernel("is in %s(0x%08x) at %s:%d while others wait for it in %s(0x%08x) at %s:%d", site.what, mask,
                           site.file, site.line, meeting.site.what, meeting.mask, meeting.site.file, meeting.site.line);
    }
    // A meeting is stored at the index of its lowest lane, so that different groups use different edges, or in the
    // first free slot if that one is taken. Each waiting lane occupies one meeting at most, so one of 32 is free.
    const std::uint32_t lowest = mask & -mask, free = warp.open & lowest ? ~warp.open & (warp.open + 1) : lowest;
    warp.open |= free;
    Meeting& meeting = warp.meetings[std::countr_zero(free)];
    meeting.site = site;
    meeting.mask = mask;
    meeting.arrived = 0;
    return meeting;
}

void Block::meet_in_warp(const Site& site, std::uint32_t mask, bool fence, void* contribution, Combine combine,
                         void* context) {
    Thread& me = lanes_[rank_]->thread;
    const unsigned first = rank_ / warp_size * warp_size;
    check_mask(site, mask);
    Warp& warp = warps_[rank_ / warp_size];
    Meeting& meeting = join(warp, site, mask);
    me.waits_in = &site;
    me.mask = mask;
    contributions_[rank_] = contribution;
    char* const edge = &meeting.edges[meeting.phase % 2];
    if (fence) release_edge(edge);
    meeting.arrived |= 1u << rank_ % warp_size;
    if (meeting.arrived == mask) {
        note_meeting(rank_ / warp_size, mask);
        if (combine) {
            const Untracked untracked;
            const Uncounted uncounted(counting_);
            combine(context, contributions_ + first);
        }
        warp.open &= ~(1u << (&meeting - warp.meetings));
        ++meeting.phase;
        spins_ = 0;
        wake_in_warp(rank_ / warp_size, mask);
    }
    pass_on(false);
    me.waits_in = nullptr;
    if (fence) acquire_edge(edge);
}

void Block::yield() {
    yielded_[rank_ / 64] |= std::uint64_t{1} << rank_ % 64;
    pass_on(false);
}

void Block::fence() {
    acquire_edge(&fence_);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    release_edge(&fence_);
}

void device_fence() {
    static char edge;
    acquire_edge(&edge);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    release_edge(&edge);
}

bool Block::in_stack_guard(const void* address) const {
    const auto* guard = static_cast<const std::byte*>(lanes_[rank_]->fiber.guard());
    return address >= guard && address < guard + page;
}

bool Block::in_shared_guard(const void* address) const {
    return address >= arena_ + arena_bytes && address < arena_ + arena_bytes + page;
}

void Block::stuck() const {
    char text[2000] = "";
    std::size_t used = 0;
    const auto say = [&](auto... arguments) {
        const int n = std::snprintf(text + used, sizeof text - used, arguments...);
        if (n > 0) used = std::min(sizeof text - 1, used + static_cast<std::size_t>(n));
    };
    // One line for each place in which threads wait.
    bool told[most_threads] = {};
    for (unsigned rank = 0; rank < size_; ++rank) {
        const Thread& thread = lanes_[rank]->thread;
        if (told[rank] || !thread.alive) continue;
        unsigned count = 0;
        for (unsigned other = rank; other < size_; ++other) {
            const Thread& o = lanes_[other]->thread;
            const bool together = o.alive && o.mask == thread.mask && !o.waits_in == !thread.waits_in &&
                                  (!thread.waits_in || same(*o.waits_in, *thread.waits_in));
            if (!together) continue;
            told[other] = true;
            ++count;
        }
        if (!thread.waits_in)
            say("\n  %u threads, the first is %u, spin in __nanosleep", count, rank);
        else if (thread.mask)
            say("\n  %u threads, the first is %u, wait in %s(0x%08x) at %s:%d", count, rank, thread.waits_in->what,
                thread.mask, thread.waits_in->file, thread.waits_in->line);
        else
            say("\n  %u threads, the first is %u, wait in %s at %s:%d", count, rank, thread.waits_in->what,
                thread.waits_in->file, thread.waits_in->line);
    }
    fail("block (%u,%u,%u) is in deadlock:%s\n  %u threads have exited", index_.x, index_.y, index_.z, text,
         size_ - alive_);
}

}  // namespace cuda_on_cpu
