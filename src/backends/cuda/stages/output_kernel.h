#pragma once

// Kernels of `output`, as templates of the type of output. Each kind of query includes this file and instantiates
// make_offsets(), list_parts() and order_buckets() for its own type, which derives from RowsOfOutput and has
//
//     Key, key(i), set_key(i, key) sort key of pair i, unique in a row
//     two_keys(i)                  key(i) and key(i + 1), where i is even
//     first_of(i)                  first element of pair i
//     flag_first(first), flag_second(key)  called at least once for the first element of each row, and for each pair
//     write(place, first, key)     writes the pair to its place in the result

#include <algorithm>

#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>

#include "backends/cuda/stages/output.h"

namespace crumple::cuda {
namespace detail {

inline constexpr unsigned short_row = 256;  ///< most pairs of a row that is sorted by comparing all with all

inline constexpr int offset_tile = 2048;  ///< first elements per tile; one block sums up the pairs of a tile
inline constexpr int offset_threads = 256, offsets_a_thread = offset_tile / offset_threads;

inline constexpr unsigned part_pairs = 2048;  ///< pairs of a part, which one block sorts in shared memory

// Lists the parts of the row of first element `a`, if the row is long.
template <class OutputArrays>
__device__ void list_parts_if_long(const OutputArrays& out, std::size_t a, unsigned long long pairs,
                                   Counters* counters) {
    if (pairs <= short_row) return;
    const unsigned long long parts = (pairs + part_pairs - 1) / part_pairs, place = atomicAdd(&counters->parts, parts);
    for (unsigned long long i = 0; i < parts && place + i < out.part_capacity; ++i)
        out.parts[place + i] = {static_cast<std::int32_t>(a), static_cast<std::uint32_t>(i)};
}

struct OffsetsShared {
    cub::BlockReduce<unsigned long long, offset_threads>::TempStorage sum;
    cub::BlockScan<unsigned long long, offset_threads>::TempStorage scan;
    std::size_t tile;           // claimed by the block
    unsigned long long before;  // pairs of all earlier tiles
};

// Waits until a tile's sum is published, and returns it. The published value is larger by one, because 0 means not yet
// published.
__device__ inline unsigned long long reported_sum(unsigned long long* tile) {
    unsigned long long told = 0;
    while ((told = atomicAdd(tile, 0ull)) == 0) __nanosleep(100);
    return told - 1;
}

// Computes prefix sums in one kernel. Blocks claim tiles in ascending order. A block publishes the sum of its tile
// before it waits for the sums of all earlier tiles. These belong to blocks that already run, so no block waits
// forever. Reading the sums of all earlier tiles costs little: there is one for 2,048 elements.
template <class OutputArrays>
__global__ void offsets_kernel(std::size_t n, OutputArrays out, Counters* counters) {
    auto& shared = dynamic_shared<OffsetsShared>();
    unsigned long long *taken = out.tiles, *told = out.tiles + 1;
    for (;;) {
        if (threadIdx.x == 0) shared.tile = atomicAdd(taken, 1ull);
        __syncthreads();
        const std::size_t tile = shared.tile;
        if (tile > n / offset_tile) break;
        const std::size_t first = tile * offset_tile + threadIdx.x * offsets_a_thread;
        unsigned long long counts[offsets_a_thread], sum = 0, place = 0, own = 0;
        for (int k = 0; k < offsets_a_thread; ++k) {
            const std::size_t i = first + static_cast<std::size_t>(k);
            counts[k] = i < n ? out.offsets[i] : 0;
            sum += counts[k];
        }
        cub::BlockScan<unsigned long long, offset_threads>(shared.scan).ExclusiveSum(sum, place);
        if (threadIdx.x == offset_threads - 1) atomicExch(&told[tile], place + sum + 1);
        for (std::size_t t = threadIdx.x; t < tile; t += offset_threads) own += reported_sum(&told[t]);
        own = cub::BlockReduce<unsigned long long, offset_threads>(shared.sum).Sum(own);
        if (threadIdx.x == 0) shared.before = own;
        __syncthreads();
        place += shared.before;
        for (int k = 0; k < offsets_a_thread; ++k) {
            const std::size_t i = first + static_cast<std::size_t>(k);
            if (i > n) break;
            out.offsets[i] = place;
            place += counts[k];
            list_parts_if_long(out, i, counts[k], counters);
        }
    }
}

template <class OutputArrays>
__global__ void parts_kernel(std::size_t n, OutputArrays out, Counters* counters) {
    for (std::size_t a = grid_thread(); a < n; a += grid_stride())
        list_parts_if_long(out, a, out.offsets[a + 1] - out.offsets[a], counters);
}

/// Range of the pairs of a part.
struct PartRange {
    unsigned long long begin, end;
};
template <class OutputArrays>
__device__ PartRange range_of(const OutputArrays& out, std::int32_t row, std::uint32_t number) {
    const unsigned long long begin = out.offsets[row] + std::uint64_t{number} * part_pairs;
    return {begin, min(begin + part_pairs, out.offsets[row + 1])};
}

template <class Key>
struct PartShared {
    Key second[part_pairs];
};

// Batcher's bitonic merge sort, in the variant whose comparisons always put the smaller key first. So it works for any
// length: keys beyond the end count as infinite and never move.
template <class Key>
__device__ void sort_part(Key* second, unsigned n) {
    for (unsigned size = 2; size / 2 < n; size *= 2) {
        for (unsigned stride = size / 2; stride > 0; stride /= 2) {
            for (unsigned i = threadIdx.x; i < n; i += blockDim.x) {
                // The first step of a merge compares mirror images, the other steps compare keys at a distance of
                // `stride`.
                const unsigned j = stride == size / 2 ? i ^ (size - 1) : i ^ stride;
                if (j <= i || j >= n || second[i] <= second[j]) continue;
                const Key swap = second[i];
                second[i] = second[j];
                second[j] = swap;
            }
            __syncthreads();
        }
    }
}

// Sets the flags, writes the pairs of short rows in order, and sorts the parts of long rows, one block per part.
template <class OutputArrays>
__global__ void order_kernel(std::size_t n, OutputArrays out, const Counters* counters) {
    using Key = typename OutputArrays::Key;
    auto& shared = dynamic_shared<PartShared<Key>>();
    const unsigned long long total = out.total(n), parts = total ? min(counters->parts, out.part_capacity) : 0;
    for (unsigned long long p = blockIdx.x; p < parts; p += gridDim.x) {
        const RowPart part = out.parts[p];
        const PartRange range = range_of(out, part.row, part.number);
        const auto count = static_cast<unsigned>(range.end - range.begin);
        for (unsigned i = threadIdx.x; i < count; i += blockDim.x) {
            shared.second[i] = out.key(range.begin + i);
            out.flag_second(shared.second[i]);
            if (i == 0) out.flag_first(part.row);
        }
        __syncthreads();
        sort_part(shared.second, count);
        for (unsigned i = threadIdx.x; i < count; i += blockDim.x) out.set_key(range.begin + i, shared.second[i]);
        __syncthreads();
    }
    for (unsigned long long i = grid_thread(); i < total; i += grid_stride()) {
        const auto a = static_cast<std::size_t>(out.first_of(i));
        const unsigned long long begin = out.offsets[a], end = out.offsets[a + 1];
        if (end - begin > short_row) continue;
        const Key b = out.key(i);
        out.flag_second(b);
        if (i == begin) out.flag_first(static_cast<std::int32_t>(a));
        unsigned rank = 0;
        unsigned long long j = begin;
        if (j % 2 == 1) rank += out.key(j++) < b;
        for (; j + 1 < end; j += 2) {
            const auto [first, second] = out.two_keys(j);
            rank += first < b;
            rank += second < b;
        }
        if (j < end) rank += out.key(j) < b;
        out.write(begin + rank, static_cast<std::int32_t>(a), b);
    }
}

// Returns how many of the sorted keys of the range are less than b.
template <class OutputArrays>
__device__ unsigned long long count_less(const OutputArrays& out, PartRange range, typename OutputArrays::Key b) {
    unsigned long long begin = range.begin, end = range.end;
    while (begin < end) {
        const unsigned long long middle = (begin + end) / 2;
        if (out.key(middle) < b)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin - range.begin;
}

// Merges the parts of each long row: each pair finds its place by binary search in all other parts. One block takes one
// part, so that many blocks share the longest row. No later kernel of the pass changes a counter that the host needs,
// so the first block copies the counters to the host.
template <class OutputArrays>
__global__ void merge_kernel(std::size_t n, OutputArrays out, const Counters* counters, Counters* told) {
    if (told && blockIdx.x == 0 && threadIdx.x == 0) *told = *counters;
    const unsigned long long parts = out.total(n) ? min(counters->parts, out.part_capacity) : 0;
    for (unsigned long long p = blockIdx.x; p < parts; p += gridDim.x) {
        const RowPart part = out.parts[p];
        const PartRange range = range_of(out, part.row, part.number);
        const unsigned long long begin = out.offsets[part.row], pairs = out.offsets[part.row + 1] - begin;
        const auto all = static_cast<std::uint32_t>((pairs + part_pairs - 1) / part_pairs);
        for (unsigned long long i = range.begin + threadIdx.x; i < range.end; i += blockDim.x) {
            const auto b = out.key(i);
            unsigned long long place = begin + (i - range.begin);
            for (std::uint32_t other = 0; other < all; ++other)
                if (other != part.number) place += count_less(out, range_of(out, part.row, other), b);
            out.write(place, part.row, b);
        }
    }
}

}  // namespace detail

template <class OutputArrays>
void make_offsets(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                  Counters* counters) {
    const auto blocks =
        static_cast<unsigned>(std::min<std::size_t>(firsts / detail::offset_tile + 1, geometry.resident));
    Launch{stream, blocks, detail::offset_threads, sizeof(detail::OffsetsShared)}(detail::offsets_kernel<OutputArrays>,
                                                                                  firsts, output, counters);
}

template <class OutputArrays>
void list_parts(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                Counters* counters) {
    Launch{stream, geometry.blocks(firsts), geometry.threads}(detail::parts_kernel<OutputArrays>, firsts, output,
                                                              counters);
}

template <class OutputArrays>
void order_buckets(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                   Counters* counters, Counters* told) {
    constexpr std::size_t shared = sizeof(detail::PartShared<typename OutputArrays::Key>);
    Launch{stream, geometry.blocks(output.capacity), geometry.threads, shared}(detail::order_kernel<OutputArrays>,
                                                                               firsts, output, counters);
    Launch{stream, geometry.blocks(32 * part_capacity(output.capacity)), geometry.threads}(
        detail::merge_kernel<OutputArrays>, firsts, output, counters, told);
}

}  // namespace crumple::cuda
