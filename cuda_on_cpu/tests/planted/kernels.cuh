#pragma once

// Kernels in plain CUDA, each with a bug that `planted` or another argument switches on. "Planted:" describes the bug.
// nvcc compiles the kernels, too, and finds nothing wrong.

#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace planted {

constexpr int threads = 64;
constexpr unsigned full = 0xffffffffu;

struct Items {
    int items[threads];
};

/// Sets out[i] to the value of the mirrored thread. Planted: no barrier between write and read.
__global__ void mirror(int* out, bool planted) {
    Items& s = portable::dynamic_shared<Items>();
    const int i = static_cast<int>(threadIdx.x);
    s.items[i] = 10 * i;
    if (!planted) __syncthreads();
    out[i] = s.items[threads - 1 - i];
}

/// Sums the values of the mirrored thread over three rounds. Planted: no barrier between a read and the next write.
__global__ void mirror_in_a_loop(int* out, bool planted) {
    Items& s = portable::dynamic_shared<Items>();
    const int i = static_cast<int>(threadIdx.x);
    int sum = 0;
    for (int round = 0; round < 3; ++round) {
        s.items[i] = (10 + round) * i;
        __syncthreads();
        sum += s.items[threads - 1 - i];
        if (!planted) __syncthreads();
    }
    out[i] = sum;
}

/// Reads the value of the neighbouring lane. Planted: a ballot where a fence is needed.
__global__ void neighbour(int* out, bool planted) {
    Items& s = portable::dynamic_shared<Items>();
    const int i = static_cast<int>(threadIdx.x);
    s.items[i] = 10 * i;
    if (planted)
        __ballot_sync(full, 1);
    else
        __syncwarp();
    out[i] = s.items[i ^ 1];
}

/// Counts blocks. Planted: the addition is not atomic.
__global__ void count_blocks(int* count, bool planted) {
    if (threadIdx.x != 0) return;
    if (planted)
        *count += 1;
    else
        atomicAdd(count, 1);
}

/// Lets the last block that arrives sum the parts of all blocks. Planted: no fence around the counter.
__global__ void last_block_sums(int* parts, unsigned* arrived, int* total, bool planted) {
    if (threadIdx.x != 0) return;
    parts[blockIdx.x] = static_cast<int>(blockIdx.x) + 1;
    if (!planted) __threadfence();
    if (atomicAdd(arrived, 1u) != gridDim.x - 1) return;
    if (!planted) __threadfence();
    int sum = 0;
    for (unsigned b = 0; b < gridDim.x; ++b) sum += parts[b];
    *total = sum;
}

enum class FenceBug { none, missing, too_early };

/// Counts the elements of a list; the warp that counts the last ones sums the counts of all warps. Planted: no fences
/// on both sides of the list's counter, or a first fence that comes before the lanes of the warp have met, so that it
/// does not cover the counts of the other lanes.
__global__ void last_warp_of_a_list_sums(unsigned* count, unsigned* arrived, unsigned* total, FenceBug bug) {
    const unsigned lane = threadIdx.x % 32;
    atomicAdd(&count[lane], 1u);
    if (lane == 0 && bug == FenceBug::too_early) __threadfence();
    __syncwarp();
    unsigned before = 0;
    if (lane == 0) {
        if (bug == FenceBug::none) __threadfence();
        before = atomicAdd(arrived, 32u);
    }
    before = __shfl_sync(full, before, 0);
    if (before + 32 < gridDim.x * blockDim.x) return;
    if (bug != FenceBug::missing) __threadfence();
    __syncwarp();
    unsigned sum = count[lane];
    for (int lanes = 16; lanes > 0; lanes /= 2) sum += __shfl_xor_sync(full, sum, lanes);
    if (lane == 0) *total = sum;
}

/// Queues each lane's bits, one per turn; the warp empties the queue by 32 at a time. Planted: the queue is read
/// without a fence.
__global__ void queue_of_bits(unsigned* out, bool planted) {
    Items& s = portable::dynamic_shared<Items>();
    const unsigned lane = threadIdx.x % 32;
    unsigned bits = 1u << lane | 1u << (31 - lane), queued = 0, sum = 0;
    while (const unsigned found = __ballot_sync(full, bits != 0)) {
        if (bits) {
            s.items[queued + static_cast<unsigned>(__popc(found & ((1u << lane) - 1)))] = __ffs(static_cast<int>(bits));
            bits &= bits - 1;
        }
        queued += static_cast<unsigned>(__popc(found));
        if (queued < 32) continue;
        if (!planted) __syncwarp();
        queued -= 32;
        sum += static_cast<unsigned>(s.items[queued + (lane ^ 1)]);
        __syncwarp();
    }
    out[threadIdx.x] = sum;
}

enum class QueueBug { lost_at_the_end, one_too_many, counted_by_those_that_add, read_while_written };

struct QueuesOfTests {
    unsigned waiting[2][63];  // a queue may hold 31 tests when 32 more are added
};

/// Returns the tests of one kind to which a lane's pair expands, one bit per test. The numbers are such that the first
/// queue fills up exactly while tests wait in the second one, that tests are added to the second one where others have
/// been read, and that both are partly full at the end.
__host__ __device__ inline unsigned tests_of_a_pair(unsigned pair, unsigned kind, unsigned lane) {
    if (kind == 0) return pair == 1 ? 3 : pair == 2 && lane < 7 ? 1 : 0;
    return pair == 0 ? lane < 5 : pair == 2 ? 3 * (lane % 2) : pair == 3 ? lane >= 27 : 0;
}
__host__ __device__ inline unsigned worth(unsigned kind, unsigned lane) { return 100 * (kind + 1) + lane; }

/// Expands pairs, one per lane, to tests of two kinds, which wait until a warp has 32 of a kind; `out` is the sum of
/// worth() of all tests. Planted, by `bug`: tests left at the end are forgotten; a queue is emptied only when it is
/// more than full; lanes that add nothing do not count the tests that others add; or the next tests are written where
/// lanes may still read.
template <QueueBug bug>
__global__ void queues_of_tests(unsigned* out, bool planted) {
    QueuesOfTests& s = portable::dynamic_shared<QueuesOfTests>();
    const unsigned lane = threadIdx.x % 32;
    const auto has = [&](QueueBug what) { return planted && what == bug; };
    unsigned queued[2] = {0, 0}, sum = 0;
    const auto test = [&](unsigned kind) {
        const unsigned n = min(queued[kind], 32u);
        queued[kind] -= n;
        if (lane < n) sum += s.waiting[kind][queued[kind] + lane];
        __ballot_sync(full, lane < n);
        if (!has(QueueBug::read_while_written)) __syncwarp();
    };
    for (unsigned pair = 0; pair < 4; ++pair)
        for (unsigned kind = 0; kind < 2; ++kind) {
            unsigned bits = tests_of_a_pair(pair, kind, lane);
            while (const unsigned having = __ballot_sync(full, bits != 0)) {
                const auto more = static_cast<unsigned>(__popc(having));
                if (bits) {
                    const auto before = static_cast<unsigned>(__popc(having & ((1u << lane) - 1)));
                    s.waiting[kind][queued[kind] + before] = worth(kind, lane);
                    bits &= bits - 1;
                    if (has(QueueBug::counted_by_those_that_add)) queued[kind] += more;
                }
                if (!has(QueueBug::counted_by_those_that_add)) queued[kind] += more;
                __syncwarp();
                if (queued[kind] >= (has(QueueBug::one_too_many) ? 33 : 32)) test(kind);
            }
        }
    for (unsigned kind = 0; kind < 2 && !has(QueueBug::lost_at_the_end); ++kind)
        while (queued[kind]) test(kind);
    for (int lanes = 16; lanes > 0; lanes /= 2) sum += __shfl_xor_sync(full, sum, lanes);
    out[threadIdx.x] = sum;
}

struct Earliest {
    unsigned long long time;
    unsigned pair;
};

/// Finds the earliest time of all hits, then the first pair at that time, in two launches. Planted by the launch: a
/// single launch does both, although the barrier in between holds for one block only.
__global__ void find_earliest(const Earliest* hits, Earliest* earliest, bool time, bool pair) {
    const Earliest& hit = hits[blockIdx.x * blockDim.x + threadIdx.x];
    if (time) atomicMin(&earliest->time, hit.time);
    __syncthreads();
    if (pair && hit.time == earliest->time) atomicMin(&earliest->pair, hit.pair);
}

/// Runs warps until their sixth lane has set a flag. Planted: each lane reads the flag for itself, so that lanes leave
/// the loop at different times.
__global__ void stop_at_a_flag(unsigned* out, bool planted) {
    Items& s = portable::dynamic_shared<Items>();
    const unsigned lane = threadIdx.x % 32;
    int* const flag = &s.items[threadIdx.x / 32];
    if (lane == 0) *flag = 0;
    __syncwarp();
    for (;;) {
        int found = 0;
        if (planted || lane == 0) found = atomicAdd(flag, 0);
        if (!planted) found = __shfl_sync(full, found, 0);
        if (found) break;
        if (lane == 5) atomicAdd(flag, 1);
        __ballot_sync(full, 1);
    }
    out[threadIdx.x] = 1;
}

/// Lets lanes vote. Each eight lanes belong to a world; the third world of each warp is decided: its lanes add nothing,
/// but must vote as the others do. Planted: they skip the vote.
__global__ void leave_out_a_world(unsigned* out, bool planted) {
    Items& s = portable::dynamic_shared<Items>();
    const unsigned lane = threadIdx.x % 32, world = threadIdx.x / 8;
    if (threadIdx.x % 8 == 0) s.items[world] = world % 4 == 2;
    __syncwarp();
    unsigned kept = 0;
    for (unsigned round = 0; round < 2; ++round) {
        const bool decided = atomicAdd(&s.items[world], 0) != 0;
        if (planted && decided) continue;
        kept = __ballot_sync(full, !decided);
    }
    out[threadIdx.x] = kept >> lane & 1;
}

/// Writes shared memory at some index. Planted: an index out of range.
__global__ void write_shared(int* out, int index) {
    int* const items = portable::dynamic_shared<Items>().items;
    items[threadIdx.x] = 1;
    __syncthreads();
    if (threadIdx.x == 5) items[index] = 2;
    __syncthreads();
    out[threadIdx.x] = items[threadIdx.x];
}

struct TwoArrays {
    int first[threads], second[threads];
};

/// Writes an array that is followed by another one in shared memory. Planted: an index out of range.
__global__ void write_array_in_shared(int* out, int index) {
    TwoArrays& s = portable::dynamic_shared<TwoArrays>();
    s.first[threadIdx.x] = s.second[threadIdx.x] = 1;
    __syncthreads();
    if (threadIdx.x == 5) s.first[index] = 2;
    __syncthreads();
    out[threadIdx.x] = s.first[threadIdx.x];
}

/// Counts threads in shared memory. Planted: nobody sets the counter to 0.
__global__ void count_threads(int* out, bool planted) {
    Items& s = portable::dynamic_shared<Items>();
    if (!planted && threadIdx.x == 0) s.items[0] = 0;
    __syncthreads();
    atomicAdd(&s.items[0], 1);
    __syncthreads();
    out[threadIdx.x] = s.items[0];
}

/// Lets even lanes vote. Planted: they name the whole warp.
__global__ void even_lanes_vote(unsigned* out, bool planted) {
    out[threadIdx.x] = 0;
    if (threadIdx.x % 2 == 0) out[threadIdx.x] = __ballot_sync(planted ? full : 0x55555555u, 1);
}

/// Lets all lanes vote. Planted: the mask lacks lane 3, which votes as well.
__global__ void a_lane_not_named_votes(unsigned* out, bool planted) {
    out[threadIdx.x] = __ballot_sync(planted ? ~8u : full, 1);
}

/// Votes in a block of any size. Planted: the mask names lanes that the last warp lacks.
__global__ void partial_warp_votes(unsigned* out, bool planted) {
    const unsigned left = blockDim.x - threadIdx.x / 32 * 32;
    const unsigned mask = planted || left >= 32 ? full : (1u << left) - 1;
    out[threadIdx.x] = __ballot_sync(mask, 1);
}

/// Lets all lanes vote with the same mask. Planted: the two halves of a warp name different masks.
__global__ void halves_disagree(unsigned* out, bool planted) {
    const unsigned mask = planted && threadIdx.x % 32 >= 16 ? 0xffff0001u : full;
    out[threadIdx.x] = __ballot_sync(mask, 1);
}

/// Counts the lanes of a warp. Planted: only those that happen to run together.
__global__ void count_lanes(int* out, bool planted) {
    out[threadIdx.x] = __popc(__ballot_sync(planted ? __activemask() : full, 1));
}

/// Reads the first lane of each half of a warp. Planted: the upper half reads a lane that its mask does not name.
__global__ void read_first_lane(int* out, bool planted) {
    const int i = static_cast<int>(threadIdx.x), half = i / 16 * 16;
    out[i] = __shfl_sync(0xffffu << half % 32, i, planted ? i / 32 * 32 : half);
}

/// Waits at a barrier. Planted: the upper half waits at another one.
__global__ void two_barriers(int* out, bool planted) {
    if (planted && threadIdx.x >= 32) {
        __syncthreads();
    } else {
        __syncthreads();
    }
    out[threadIdx.x] = 1;
}

/// Waits at a barrier. Planted: threads from 40 on have exited.
__global__ void leave_early(int* out, bool planted) {
    out[threadIdx.x] = 1;
    if (planted && threadIdx.x >= 40) return;
    __syncthreads();
    out[threadIdx.x] = 2;
}

/// Lets the first warp vote, then waits at a barrier of the block. Planted: lane 7 goes to the barrier at once.
__global__ void barrier_instead_of_vote(unsigned* out, bool planted) {
    unsigned votes = 0;
    if (threadIdx.x < 32 && !(planted && threadIdx.x == 7)) votes = __ballot_sync(full, 1);
    __syncthreads();
    out[threadIdx.x] = votes;
}

/// Waits for a flag. Planted: nobody sets it.
__global__ void wait_for_flag(unsigned* flag, bool planted) {
    if (threadIdx.x == 0 && !planted) atomicExch(flag, 1u);
    while (atomicAdd(flag, 0u) == 0) __nanosleep(20);
}

/// Writes an element of an array. Planted: an index out of range.
__global__ void write_global(int* out, long long index) { out[index] = 1; }

/// Adds the results of two scans. Planted: no barrier before the storage is used again.
__global__ void two_scans(int* out, bool planted) {
    using Scan = cub::BlockScan<int, threads>;
    auto& storage = portable::dynamic_shared<Scan::TempStorage>();
    int first, second;
    Scan(storage).ExclusiveSum(1, first);
    if (!planted) __syncthreads();
    Scan(storage).ExclusiveSum(2, second);
    out[threadIdx.x] = first + second;
}

/// Returns a sum over all threads to each of them. Planted: threads use their own result, though only the first has
/// one.
__global__ void sum_for_all(int* out, bool planted) {
    using Reduce = cub::BlockReduce<int, threads>;
    struct Shared {
        Reduce::TempStorage storage;
        int sum;
    };
    Shared& s = portable::dynamic_shared<Shared>();
    const int sum = Reduce(s.storage).Sum(1);
    if (threadIdx.x == 0) s.sum = sum;
    __syncthreads();
    out[threadIdx.x] = planted ? sum : s.sum;
}

/// Scans over 64 threads. Planted by the launch, which has another number of threads.
__global__ void scan_of_64(int* out) {
    using Scan = cub::BlockScan<int, threads>;
    auto& storage = portable::dynamic_shared<Scan::TempStorage>();
    int place;
    Scan(storage).ExclusiveSum(1, place);
    out[threadIdx.x] = place;
}

__device__ inline int deep(int n, volatile int* filler) {
    volatile int mine[256];
    mine[n % 256] = n + filler[0];
    return n == 0 ? mine[0] : deep(n - 1, mine + n % 256) + mine[n % 256] % 2;
}
/// Calls itself. Planted: a depth that no stack holds.
__global__ void recurse(int* out, int depth) {
    volatile int zero = 0;
    out[0] = deep(depth, &zero);
}

__global__ void load_four(const float* in, float* out, int offset) {
    *out = reinterpret_cast<const float4*>(in + offset)->y;
}

}  // namespace planted
