#pragma once

// The kernels of `output`, for those who write rows of their own: a question includes this and instantiates
// make_offsets(), list_parts() and order_buckets() for its output, which has, beside what Output has of numbers and
// parts,
//
//     Key, Key* second             what rows are ordered by, unique in a row
//     set_flags(first, key)        called once for each pair
//     write(place, first, key)     the pair's place in the answer

#include <algorithm>

#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>

#include "backends/cuda/stages/output.h"

namespace crumple::cuda {
namespace detail {

inline constexpr unsigned short_row =
    64;  ///< pairs of a first triangle that each find their place by looking at all others

inline constexpr int offset_threads = 256, offsets_a_thread = offset_tile / offset_threads;

inline constexpr unsigned part_pairs = 2048;  ///< of a long row, which a block sorts in shared memory

// Lists the parts of first triangle `a`'s row, if it is long.
template <class OutputArrays>
__device__ void list_row(const OutputArrays& out, std::size_t a, unsigned long long pairs, Counters* counters) {
    if (pairs <= short_row) return;
    const unsigned long long parts = (pairs + part_pairs - 1) / part_pairs, place = atomicAdd(&counters->parts, parts);
    for (unsigned long long i = 0; i < parts && place + i < out.part_capacity; ++i)
        out.parts[place + i] = {static_cast<std::int32_t>(a), static_cast<std::uint32_t>(i)};
}

struct OffsetsShared {
    cub::BlockReduce<unsigned long long, offset_threads>::TempStorage sum;
    cub::BlockScan<unsigned long long, offset_threads>::TempStorage scan;
    unsigned long long before;  // pairs of all tiles that come first
};

// Prefix sums in one kernel: tiles were counted beside the triangles, so a block learns where its tile begins without
// waiting for another block. That it reads the numbers of all tiles before is little: there is one for 2,048 triangles.
template <class OutputArrays>
__global__ void offsets_kernel(std::size_t n, OutputArrays out, Counters* counters) {
    auto& shared = dynamic_shared<OffsetsShared>();
    for (std::size_t tile = blockIdx.x; tile <= n / offset_tile; tile += gridDim.x) {
        unsigned long long own = 0;
        for (std::size_t t = threadIdx.x; t < tile; t += offset_threads) own += out.by_tile[t];
        __syncthreads();
        own = cub::BlockReduce<unsigned long long, offset_threads>(shared.sum).Sum(own);
        if (threadIdx.x == 0) shared.before = own;
        const std::size_t first = tile * offset_tile + threadIdx.x * offsets_a_thread;
        unsigned long long sum = 0, place = 0;
        for (std::size_t i = first; i < first + offsets_a_thread; ++i) sum += i < n ? out.offsets[i] : 0;
        cub::BlockScan<unsigned long long, offset_threads>(shared.scan).ExclusiveSum(sum, place);
        __syncthreads();
        place += shared.before;
        for (std::size_t i = first; i < first + offsets_a_thread && i <= n; ++i) {
            const unsigned long long count = i < n ? out.offsets[i] : 0;
            out.offsets[i] = place;
            place += count;
            list_row(out, i, count, counters);
        }
    }
}

template <class OutputArrays>
__global__ void parts_kernel(std::size_t n, OutputArrays out, Counters* counters) {
    for (std::size_t a = grid_thread(); a < n; a += grid_stride())
        list_row(out, a, out.offsets[a + 1] - out.offsets[a], counters);
}

/// Where a part's pairs are.
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

// Batcher's bitonic merge sort, in the form that always puts the smaller one first, so that any length will do: what
// lies behind the end counts as infinite and never moves.
template <class Key>
__device__ void sort_part(Key* second, unsigned n) {
    for (unsigned size = 2; size / 2 < n; size *= 2) {
        for (unsigned stride = size / 2; stride > 0; stride /= 2) {
            for (unsigned i = threadIdx.x; i < n; i += blockDim.x) {
                // The first step of a merge compares mirror images, the others neighbours at a stride.
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

// Flags; the pairs of short rows in order; parts of long rows sorted, a block a part.
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
            shared.second[i] = out.second[range.begin + i];
            out.set_flags(static_cast<std::size_t>(part.row), shared.second[i]);
        }
        __syncthreads();
        sort_part(shared.second, count);
        for (unsigned i = threadIdx.x; i < count; i += blockDim.x) out.second[range.begin + i] = shared.second[i];
        __syncthreads();
    }
    for (unsigned long long i = grid_thread(); i < total; i += grid_stride()) {
        const std::size_t a = segment_of(i, out.offsets, n);
        const unsigned long long begin = out.offsets[a], end = out.offsets[a + 1];
        if (end - begin > short_row) continue;
        const Key b = out.second[i];
        out.set_flags(a, b);
        unsigned long long rank = 0;
        for (unsigned long long j = begin; j < end; ++j) rank += out.second[j] < b;
        out.write(begin + rank, static_cast<std::int32_t>(a), b);
    }
}

// How many of the sorted values [begin, end) are less than b.
template <class Key>
__device__ unsigned long long count_less(const Key* second, PartRange range, Key b) {
    unsigned long long begin = range.begin, end = range.end;
    while (begin < end) {
        const unsigned long long middle = (begin + end) / 2;
        if (second[middle] < b)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin - range.begin;
}

// Each pair of a long row finds its place by bisection in all parts, which are merged by that: a block a part, so that
// the longest row is the whole device's. It is a pass's last kernel, so all counters have their values, and the first
// block tells the host.
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
            const auto b = out.second[i];
            unsigned long long place = begin + (i - range.begin);
            for (std::uint32_t other = 0; other < all; ++other)
                if (other != part.number) place += count_less(out.second, range_of(out, part.row, other), b);
            out.write(place, part.row, b);
        }
    }
}

}  // namespace detail

template <class OutputArrays>
void make_offsets(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                  Counters* counters) {
    const auto blocks = static_cast<unsigned>(std::min<std::size_t>(offset_tiles(firsts), geometry.resident));
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
