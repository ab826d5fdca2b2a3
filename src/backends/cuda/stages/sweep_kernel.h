#pragma once

// Kernel of `sweep`, as a template of the filter. Each kind of query includes this file and instantiates sweep() for
// its filter.
//
// Each block has a share of the units, and its warps take these one by one. A unit is 32 rows and 32 columns. A lane
// holds one column; the rows lie in shared memory and are tested in turn. Rows that end before the unit's first column
// are skipped, because intervals differ much in length. A lane collects its overlaps as the bits of one word, without a
// branch or a vote per row. Overlaps wait in a queue of the warp until there are 32 candidates, one per lane, for the
// tests that gather from memory. Survivors wait in a second queue until there are enough to append them to the list
// with one atomic.

#include "backends/cuda/device/block_counter.h"
#include "backends/cuda/device/warp_queue.h"
#include "backends/cuda/stages/sweep.h"

namespace crumple::cuda {
namespace detail {

using SurvivorQueue = ListQueue<Candidate, 160>;

template <class Filter>
struct WarpShared {
    // A unit's rows are read by overlaps_of() only, the buffer by test_candidates() only.
    union {
        SortedRow row[32];
        typename Filter::Buffer buffer;
    };
    WarpQueue<Candidate>::Places candidates;
    SurvivorQueue::Places survivors;
};
template <int threads, class Filter>
struct SweepShared {
    WarpShared<Filter> warp[threads / 32];
    unsigned taken;  // units that the block's warps have taken
    BlockShared block;
};

// Returns true if the boxes of a column and of an earlier row overlap, and no conflict bit (SortedRow) is set in both.
__device__ inline bool overlap(const SortedRow& a, std::uint32_t column, const SortedRow& row) {
    return !(a.conflict & row.conflict) & (column < row.end) & !(a.box.low_y > row.box.high_y) &
           !(a.box.high_y < row.box.low_y) & !(a.box.low_z > row.box.high_z) & !(a.box.high_z < row.box.low_z);
}

// Work of one warp. All lanes call its functions together.
template <class Filter>
struct Sweep {
    const PreparedScene& scene;
    const Sorted& sorted;
    const Ownership& ownership;
    const PairSelection& wanted;
    const Filter& filter;
    WarpShared<Filter>& shared;
    SurvivorQueue survivors;
    WarpQueue<Candidate> candidates{shared.candidates};
    unsigned lane = threadIdx.x % 32;
    unsigned long long overlaps = 0;

    __device__ bool is_ours(std::uint32_t leaf, std::int32_t a, std::int32_t b) const {
        if (!ownership.upper_mask) return true;
        const auto cluster = leaf / static_cast<std::uint32_t>(ownership.last_fan_out) %
                             static_cast<std::uint32_t>(ownership.upper_fan_out);
        return !(ownership.upper_mask[a] & ownership.upper_mask[b] & ((std::uint64_t{1} << cluster) - 1));
    }
    __device__ bool passes_pair_filter(const Candidate& c) const {
        if (!ownership.upper_mask && wanted.all()) return true;
        const std::int32_t a = sorted.row[c.row].triangle, b = sorted.row[c.column].triangle;
        return is_ours(sorted.leaf[c.row], a, b) && (wanted.all() || wanted(scene.group(a), scene.group(b)));
    }

    // Tests the unit's columns against its rows. Returns the rows that the lane's column overlaps, one bit for each.
    __device__ unsigned overlaps_of(const SweepUnit& unit) {
        const bool has_row = unit.row + lane < unit.row_end;
        const std::uint32_t column = unit.column + lane;
        const bool has_column = column < unit.column_end;
        const SortedRow row = has_row ? sorted.row[unit.row + lane] : SortedRow{};
        const SortedRow own = has_column ? sorted.row[column] : SortedRow{};
        shared.row[lane] = row;
        __syncwarp();
        unsigned overlapping = 0, open = __ballot_sync(whole_warp, row.end > unit.column);
        const auto meet = [&] {
            const int last = 31 - __clz(static_cast<int>(open));
            const unsigned bit = 1u << last;
            open ^= bit;
            overlapping |= overlap(own, column, shared.row[last]) ? bit : 0u;
        };
        if (__popc(open) & 1) meet();
        while (open) meet(), meet();  // two at a time, so that one does not wait for the other
        __syncwarp();
        // Removes rows that do not come before the column: a row's columns come after it.
        const std::uint32_t before = column - unit.row;
        if (before < 32) overlapping &= (1u << before) - 1;
        return has_column ? overlapping : 0;
    }
    __device__ void sweep(const SweepUnit& unit) {
        unsigned rows = overlaps_of(unit);
        while (const unsigned having = __ballot_sync(whole_warp, rows != 0)) {
            const auto row = unit.row + static_cast<std::uint32_t>(31 - __clz(static_cast<int>(rows)));
            candidates.add(rows != 0, {row, unit.column + lane}, having);
            if (rows) rows ^= 1u << (row - unit.row);
            if (candidates.size() >= 32) test_candidates();
        }
    }
    // Tests the last candidates of the queue, up to 32.
    __device__ void test_candidates() {
        Candidate c{};
        const unsigned taken = candidates.take(c);
        survivors.add(filter.keeps(lane < taken && passes_pair_filter(c), c, shared.buffer), c);
        overlaps += taken;
    }
};

template <int threads, class Filter>
__global__ void __launch_bounds__(threads)
    sweep_kernel(PreparedScene scene, Sorted sorted, List<SweepUnit> units, Ownership ownership, PairSelection wanted,
                 Filter filter, List<Candidate> list, Slice slice, Counters* counters) {
    auto& shared = dynamic_shared<SweepShared<threads, Filter>>();
    WarpShared<Filter>& own = shared.warp[threadIdx.x / 32];
    Sweep<Filter> sweep{scene, sorted, ownership, wanted, filter, own, SurvivorQueue(own.survivors, list)};
    if (threadIdx.x == 0) shared.taken = 0;
    __syncthreads();
    const unsigned long long all = (units.filled() + slice.step - 1) / slice.step;
    const unsigned long long begin = all * slice.turn / slice.turns,
                             end = all * (slice.turn + slice.count) / slice.turns;
    while (!has_ended(slice.found)) {
        unsigned taken = 0;
        if (sweep.lane == 0) taken = atomicAdd(&shared.taken, 1u);
        taken = __shfl_sync(whole_warp, taken, 0);
        const unsigned long long number = begin + std::uint64_t{taken} * gridDim.x + blockIdx.x;
        if (number >= end) break;
        const SweepUnit unit = units.data[number * slice.step];
        if (!slice.decided.count || !has_ended(slice.decided.of(sorted.leaf[unit.row]))) sweep.sweep(unit);
    }
    while (sweep.candidates.size()) sweep.test_candidates();
    // One atomic for the block, not one for each warp, because all blocks end at about the same time.
    sweep.survivors.write(reserve_by_block(sweep.survivors.size(), list.count, shared.block));
    add_by_block(sweep.lane == 0 ? sweep.overlaps : 0, &counters->box_overlaps, shared.block);
}

}  // namespace detail

template <class Filter>
void sweep(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
           const List<SweepUnit>& units, const Ownership& ownership, const PairSelection& wanted, const Filter& filter,
           const List<Candidate>& survivors, const Slice& slice, Counters* counters) {
    const auto run = [&]<int threads>() {
        constexpr auto kernel = detail::sweep_kernel<threads, Filter>;
        constexpr std::size_t shared = sizeof(detail::SweepShared<threads, Filter>);
        Launch{stream, geometry.fitting(kernel, shared, threads), threads, shared}(
            kernel, scene, sorted, units, ownership, wanted, filter, survivors, slice, counters);
    };
    // Blocks get more than 48 KiB of shared memory only by opting in.
    constexpr int most = sizeof(detail::SweepShared<256, Filter>) <= 48 * 1024 ? 256 : 128;
    geometry.threads == 64 ? run.template operator()<64>() : run.template operator()<most>();
}

}  // namespace crumple::cuda
