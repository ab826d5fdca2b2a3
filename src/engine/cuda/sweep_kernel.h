#pragma once

// The kernel of `sweep`, for those who bring a filter: a question includes this and instantiates sweep<Filter>().
//
// A warp sweeps 32 rows at a time, one a lane, against columns that all lanes read from shared memory. What overlaps
// waits in a queue of the warp until there are 32 candidates, one a lane again, for the tests that gather from memory;
// what these leave waits in a second queue until 32 places in the list can be had by one atomic. So lanes are busy
// however the overlaps fall, and there is no barrier beyond the warp's.

#include "engine/cuda/sweep.h"

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
    const auto cluster = leaf / static_cast<std::uint32_t>(o.last_fan_out);
    return !(o.upper_mask[a] & o.upper_mask[b] & ((std::uint64_t{1} << cluster) - 1));
}

template <class Filter>
struct Sweep {
    const Scene& scene;
    const Sorted& sorted;
    const Ownership& ownership;
    const WantedGroups& groups;
    const Filter& filter;
    const List<Candidate>& list;
    WarpShared& shared;
    unsigned lane;
    unsigned candidates = 0, survivors = 0;  // in the queues, the same in all lanes
    unsigned long long overlaps = 0;

    __device__ bool keeps(const Candidate& c) const {
        const std::int32_t a = sorted.triangle[c.row], b = sorted.triangle[c.column];
        if (!ours(ownership, sorted.leaf[c.row], a, b)) return false;
        if (!groups.all() && !groups(scene.group(a), scene.group(b))) return false;
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

    __device__ void finish() {
        while (candidates) test_candidates();
        while (survivors) list_survivors();
    }
};

template <int threads, class Filter>
__global__ void __launch_bounds__(threads)
    sweep_kernel(Scene scene, Sorted sorted, const unsigned long long* members, Ownership ownership,
                 WantedGroups groups, Filter filter, List<Candidate> list, Slice slice, Counters* counters) {
    const unsigned lane = threadIdx.x % 32;
    WarpShared& shared = dynamic_shared<SweepShared<threads>>().warp[threadIdx.x / 32];
    Sweep<Filter> sweep{scene, sorted, ownership, groups, filter, list, shared, lane};
    const std::size_t rows = *members, row_groups = (rows + 31) / 32;
    const unsigned long long all = sorted.unit_first[row_groups], begin_unit = all * slice.turn / slice.turns;
    const unsigned long long end_unit = all * (slice.turn + 1) / slice.turns;
    // Units differ in cost, so warps take some at a time: few, or the last one would be late.
    const unsigned long long share = (end_unit - begin_unit) / (shares_a_warp * (grid_stride() / 32)) + 1;
    std::size_t group = 0;
    unsigned long long unit = 0, last = 0;
    for (;; ++unit) {
        if (unit == last) {
            if (lane == 0) unit = begin_unit + atomicAdd(&counters->next_unit, share);
            unit = __shfl_sync(whole_warp, unit, 0);
            last = min(unit + share, end_unit);
            if (unit >= end_unit) break;
        }
        if (unit < sorted.unit_first[group] || unit >= sorted.unit_first[group + 1])
            group = segment_of(unit, sorted.unit_first, row_groups);
        const auto row = static_cast<std::uint32_t>(32 * group) + lane;
        const bool valid = row < rows;
        const CrossBox box = valid ? sorted.box[row] : CrossBox{};
        const std::uint64_t conflict = valid ? sorted.conflict[row] : 0;
        const std::uint32_t row_end = valid ? sorted.end[row] : 0;
        const auto chunk = static_cast<std::uint32_t>(unit - sorted.unit_first[group]);
        const std::uint32_t begin = static_cast<std::uint32_t>(32 * group) + 1 + chunk * unit_columns;
        const std::uint32_t end = min(begin + unit_columns, sorted.group_end[group]);
        for (std::uint32_t first = begin; first < end; first += 32) {
            if (first + lane < end) {
                shared.box[lane] = sorted.box[first + lane];
                shared.conflict[lane] = sorted.conflict[first + lane];
            }
            __syncwarp();
            const std::uint32_t n = min(end - first, 32u);
            for (std::uint32_t k = 0; k < n; ++k) {
                const CrossBox other = shared.box[k];
                const std::uint32_t column = first + k;
                const bool overlap = column > row && column < row_end && !(conflict & shared.conflict[k]) &&
                                     !(other.low_y > box.high_y) && !(other.high_y < box.low_y) &&
                                     !(other.low_z > box.high_z) && !(other.high_z < box.low_z);
                const unsigned found = __ballot_sync(whole_warp, overlap);
                if (!found) continue;
                if (overlap)
                    shared.candidate[sweep.candidates + static_cast<unsigned>(__popc(found & ((1u << lane) - 1)))] = {
                        row, column};
                sweep.candidates += static_cast<unsigned>(__popc(found));
                if (sweep.candidates < 32) continue;
                __syncwarp();
                sweep.test_candidates();
            }
            __syncwarp();
        }
    }
    __syncwarp();
    sweep.finish();
    if (lane == 0 && sweep.overlaps) atomicAdd(&counters->box_overlaps, sweep.overlaps);
}

}  // namespace detail

template <class Filter>
void sweep(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Sorted& sorted,
           const unsigned long long* members, const Ownership& ownership, const WantedGroups& groups,
           const Filter& filter, const List<Candidate>& survivors, const Slice& slice, Counters* counters) {
    const auto run = [&]<int threads>() {
        constexpr auto kernel = detail::sweep_kernel<threads, Filter>;
        constexpr std::size_t shared = sizeof(detail::SweepShared<threads>);
        Launch{stream, geometry.fitting(kernel, shared), threads, shared}(kernel, scene, sorted, members, ownership,
                                                                          groups, filter, survivors, slice, counters);
    };
    if (geometry.threads == 64)
        run.template operator()<64>();
    else
        run.template operator()<256>();
}

}  // namespace crumple::cuda
