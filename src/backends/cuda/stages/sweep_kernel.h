#pragma once

// The kernel of `sweep`, for those who bring a filter: a question includes this and instantiates sweep<Filter>().
//
// A warp sweeps 32 rows at a time, one a lane, against 32 columns that all lanes read from shared memory: a lane's
// overlaps are the bits of one word, which takes no branch and no vote a column. They wait in a queue of the warp until
// there are 32 candidates, one a lane again, for the tests that gather from memory; what these leave waits in a second
// queue until 32 places in the list can be had by one atomic. So lanes are busy however the overlaps fall, and there is
// no barrier beyond the warp's.

#include "backends/cuda/stages/sweep.h"

namespace crumple::cuda {
namespace detail {

inline constexpr unsigned long long shares_a_warp = 8;

struct WarpShared {
    CrossBox box[32];
    std::uint64_t conflict[32];
    Candidate candidate[64], survivor[64];
};
template <int threads>
struct SweepShared {
    WarpShared warp[threads / 32];
};

__device__ inline bool ours(const Ownership& o, std::uint32_t leaf, std::int32_t a, std::int32_t b) {
    if (!o.upper_mask) return true;
    const auto cluster =
        leaf / static_cast<std::uint32_t>(o.last_fan_out) % static_cast<std::uint32_t>(o.upper_fan_out);
    return !(o.upper_mask[a] & o.upper_mask[b] & ((std::uint64_t{1} << cluster) - 1));
}

template <class Filter>
struct Sweep {
    const PreparedScene& scene;
    const Sorted& sorted;
    const Ownership& ownership;
    const WantedPairs& wanted;
    const Filter& filter;
    const List<Candidate>& list;
    WarpShared& shared;
    unsigned lane;
    unsigned candidates = 0, survivors = 0;  // in the queues, the same in all lanes
    unsigned long long overlaps = 0;

    __device__ bool keeps(const Candidate& c) const {
        const std::int32_t a = sorted.triangle[c.row], b = sorted.triangle[c.column];
        if (!ours(ownership, sorted.leaf[c.row], a, b)) return false;
        if (!wanted.all() && !wanted(scene.group(a), scene.group(b))) return false;
        return filter(c);
    }

    // Moves the last survivors of the queue, up to 32, to the list.
    __device__ void list_survivors() {
        const unsigned n = min(survivors, 32u), first = survivors - n;
        unsigned long long place = 0;
        if (lane == 0) place = atomicAdd(list.count, static_cast<unsigned long long>(n));
        place = __shfl_sync(whole_warp, place, 0) + lane;
        if (lane < n && place < list.capacity) list.data[place] = shared.survivor[first + lane];
        __syncwarp();
        survivors = first;
    }

    // Tests the last candidates of the queue, up to 32.
    __device__ void test_candidates() {
        const unsigned n = min(candidates, 32u), first = candidates - n;
        Candidate c{};
        const bool keep = lane < n && (c = shared.candidate[first + lane], keeps(c));
        const unsigned kept = __ballot_sync(whole_warp, keep);
        if (keep) shared.survivor[survivors + static_cast<unsigned>(__popc(kept & ((1u << lane) - 1)))] = c;
        __syncwarp();
        candidates = first;
        survivors += static_cast<unsigned>(__popc(kept));
        overlaps += n;
        if (survivors >= 32) list_survivors();
    }

    // Queues the lane's overlaps, a bit a column from `first` on.
    __device__ void queue(std::uint32_t row, std::uint32_t first, unsigned overlapping) {
        while (const unsigned found = __ballot_sync(whole_warp, overlapping != 0)) {
            if (overlapping) {
                const auto column = first + static_cast<std::uint32_t>(__ffs(static_cast<int>(overlapping)) - 1);
                shared.candidate[candidates + static_cast<unsigned>(__popc(found & ((1u << lane) - 1)))] = {row,
                                                                                                            column};
                overlapping &= overlapping - 1;
            }
            candidates += static_cast<unsigned>(__popc(found));
            if (candidates < 32) continue;
            __syncwarp();
            test_candidates();
        }
    }

    __device__ void finish() {
        while (candidates) test_candidates();
        while (survivors) list_survivors();
    }
};

// Bits of the columns [first, first + 32) that lie in [begin, end).
__device__ inline unsigned columns_within(std::uint32_t first, std::uint32_t begin, std::uint32_t end) {
    const auto below = [&](std::uint32_t c) {
        return c <= first ? 0u : c - first >= 32 ? ~0u : (1u << (c - first)) - 1;
    };
    return below(end) & ~below(begin);
}

template <int threads, class Filter>
__global__ void __launch_bounds__(threads)
    sweep_kernel(PreparedScene scene, Sorted sorted, List<Unit> units, Ownership ownership, WantedPairs wanted,
                 Filter filter, List<Candidate> list, Slice slice, Counters* counters) {
    const unsigned lane = threadIdx.x % 32;
    WarpShared& shared = dynamic_shared<SweepShared<threads>>().warp[threadIdx.x / 32];
    Sweep<Filter> sweep{scene, sorted, ownership, wanted, filter, list, shared, lane};
    const unsigned long long all = (units.filled() + slice.step - 1) / slice.step;
    const unsigned long long begin_unit = all * slice.turn / slice.turns;
    const unsigned long long end_unit = all * (slice.turn + slice.count) / slice.turns;
    // Units differ in cost, so warps take some at a time: few, or the last one would be late.
    const unsigned long long share = (end_unit - begin_unit) / (shares_a_warp * (grid_stride() / 32)) + 1;
    unsigned long long number = 0, last = 0;
    for (;; ++number) {
        if (number == last) {
            if (has_ended(slice.found)) break;
            if (lane == 0) number = begin_unit + atomicAdd(&counters->next_unit, share);
            number = __shfl_sync(whole_warp, number, 0);
            last = min(number + share, end_unit);
            if (number >= end_unit) break;
        }
        const Unit unit = units.data[number * slice.step];
        if (slice.decided.count && has_ended(slice.decided.of(sorted.leaf[unit.row]))) continue;
        const std::uint32_t row = unit.row + lane;
        const bool valid = row < unit.row_end;
        const CrossBox box = valid ? sorted.box[row] : CrossBox{};
        const std::uint64_t conflict = valid ? sorted.conflict[row] : 0;
        const std::uint32_t row_end = valid ? sorted.end[row] : 0;
        for (std::uint32_t first = unit.column; first < unit.column_end; first += 32) {
            if (first + lane < unit.column_end) {
                shared.box[lane] = sorted.box[first + lane];
                shared.conflict[lane] = sorted.conflict[first + lane];
            }
            __syncwarp();
            const std::uint32_t n = min(unit.column_end - first, 32u);
            unsigned overlapping = 0;
            for (std::uint32_t k = 0; k < n; ++k) {
                const CrossBox other = shared.box[k];
                const bool overlap = !(conflict & shared.conflict[k]) & !(other.low_y > box.high_y) &
                                     !(other.high_y < box.low_y) & !(other.low_z > box.high_z) &
                                     !(other.high_z < box.low_z);
                overlapping |= static_cast<unsigned>(overlap) << k;
            }
            sweep.queue(row, first, overlapping & columns_within(first, row + 1, row_end));
            __syncwarp();
        }
    }
    __syncwarp();
    sweep.finish();
    if (lane == 0 && sweep.overlaps) atomicAdd(&counters->box_overlaps, sweep.overlaps);
}

}  // namespace detail

template <class Filter>
void sweep(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
           const List<Unit>& units, const Ownership& ownership, const WantedPairs& wanted, const Filter& filter,
           const List<Candidate>& survivors, const Slice& slice, Counters* counters) {
    const auto run = [&]<int threads>() {
        constexpr auto kernel = detail::sweep_kernel<threads, Filter>;
        constexpr std::size_t shared = sizeof(detail::SweepShared<threads>);
        Launch{stream, geometry.fitting(kernel, shared), threads, shared}(kernel, scene, sorted, units, ownership,
                                                                          wanted, filter, survivors, slice, counters);
    };
    if (geometry.threads == 64)
        run.template operator()<64>();
    else
        run.template operator()<256>();
}

}  // namespace crumple::cuda
