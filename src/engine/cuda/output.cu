#include "engine/cuda/output.h"

#include <algorithm>

#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>

namespace crumple::cuda {
namespace {

constexpr unsigned short_row = 64;  ///< pairs of a first triangle that each find their place by looking at all others

constexpr int offset_threads = 256, offsets_a_thread = offset_tile / offset_threads;

constexpr unsigned part_pairs = 2048;  ///< of a long row, which a block sorts in shared memory

// Lists the parts of first triangle `a`'s row, if it is long.
__device__ void list_row(const Output& out, std::size_t a, unsigned long long pairs, Counters* counters) {
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
__global__ void offsets_kernel(std::size_t n, Output out, Counters* counters) {
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

__global__ void bucket_kernel(List<Hit> hits, std::int32_t second, Output out) {
    const unsigned long long n = hits.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride()) {
        const Hit hit = hits.data[i];
        const unsigned long long place = out.offsets[hit.a] + hit.rank;
        if (place < out.capacity) out.second[place] = hit.b - second;
    }
}

// Sets one byte. Many threads may set the same one at once, so it is done by an atomic on its word.
__device__ void flag(std::uint8_t* flags, std::size_t i) {
    atomicOr(reinterpret_cast<unsigned*>(flags) + i / 4, 1u << 8 * (i % 4));
}

__global__ void parts_kernel(std::size_t n, Output out, Counters* counters) {
    for (std::size_t a = grid_thread(); a < n; a += grid_stride())
        list_row(out, a, out.offsets[a + 1] - out.offsets[a], counters);
}

/// Where a part's pairs are.
struct PartRange {
    unsigned long long begin, end;
};
__device__ PartRange range_of(const Output& out, std::int32_t row, std::uint32_t number) {
    const unsigned long long begin = out.offsets[row] + std::uint64_t{number} * part_pairs;
    return {begin, min(begin + part_pairs, out.offsets[row + 1])};
}

struct PartShared {
    std::int32_t second[part_pairs];
};

// Batcher's bitonic merge sort, in the form that always puts the smaller one first, so that any length will do: what
// lies behind the end counts as infinite and never moves.
__device__ void sort_part(std::int32_t* second, unsigned n) {
    for (unsigned size = 2; size / 2 < n; size *= 2) {
        for (unsigned stride = size / 2; stride > 0; stride /= 2) {
            for (unsigned i = threadIdx.x; i < n; i += blockDim.x) {
                // The first step of a merge compares mirror images, the others neighbours at a stride.
                const unsigned j = stride == size / 2 ? i ^ (size - 1) : i ^ stride;
                if (j <= i || j >= n || second[i] <= second[j]) continue;
                const std::int32_t swap = second[i];
                second[i] = second[j];
                second[j] = swap;
            }
            __syncthreads();
        }
    }
}

// Flags; the pairs of short rows in order; parts of long rows sorted, a block a part.
__global__ void order_kernel(std::size_t n, bool between, Output out, const Counters* counters) {
    auto& shared = dynamic_shared<PartShared>();
    const unsigned long long total = out.total(n), parts = total ? min(counters->parts, out.part_capacity) : 0;
    const auto set_flags = [&](std::size_t a, std::int32_t b) {
        flag(out.hit, a);
        flag(between ? out.hit_second : out.hit, static_cast<std::size_t>(b));
    };
    for (unsigned long long p = blockIdx.x; p < parts; p += gridDim.x) {
        const RowPart part = out.parts[p];
        const PartRange range = range_of(out, part.row, part.number);
        const auto count = static_cast<unsigned>(range.end - range.begin);
        for (unsigned i = threadIdx.x; i < count; i += blockDim.x) {
            shared.second[i] = out.second[range.begin + i];
            set_flags(static_cast<std::size_t>(part.row), shared.second[i]);
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
        const std::int32_t b = out.second[i];
        set_flags(a, b);
        unsigned long long rank = 0;
        for (unsigned long long j = begin; j < end; ++j) rank += out.second[j] < b;
        out.pairs[begin + rank] = {static_cast<std::int32_t>(a), b};
    }
}

// How many of the sorted values [begin, end) are less than b.
__device__ unsigned long long count_less(const std::int32_t* second, PartRange range, std::int32_t b) {
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
__global__ void merge_kernel(std::size_t n, Output out, const Counters* counters, Counters* told) {
    if (told && blockIdx.x == 0 && threadIdx.x == 0) *told = *counters;
    const unsigned long long parts = out.total(n) ? min(counters->parts, out.part_capacity) : 0;
    for (unsigned long long p = blockIdx.x; p < parts; p += gridDim.x) {
        const RowPart part = out.parts[p];
        const PartRange range = range_of(out, part.row, part.number);
        const unsigned long long begin = out.offsets[part.row], pairs = out.offsets[part.row + 1] - begin;
        const auto all = static_cast<std::uint32_t>((pairs + part_pairs - 1) / part_pairs);
        for (unsigned long long i = range.begin + threadIdx.x; i < range.end; i += blockDim.x) {
            const std::int32_t b = out.second[i];
            unsigned long long place = begin + (i - range.begin);
            for (std::uint32_t other = 0; other < all; ++other)
                if (other != part.number) place += count_less(out.second, range_of(out, part.row, other), b);
            out.pairs[place] = {part.row, b};
        }
    }
}

}  // namespace

std::size_t offset_tiles(std::size_t first_triangles) { return first_triangles / offset_tile + 1; }

std::size_t whole_words(std::size_t flags) { return (flags + 3) / 4 * 4; }

std::size_t part_capacity(std::size_t pairs) { return pairs / short_row + pairs / part_pairs + 1; }

void make_offsets(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Output& output,
                  Counters* counters) {
    const auto n = static_cast<std::size_t>(scene.triangles[0]);
    const auto blocks = static_cast<unsigned>(std::min<std::size_t>(offset_tiles(n), geometry.resident));
    Launch{stream, blocks, offset_threads, sizeof(OffsetsShared)}(offsets_kernel, n, output, counters);
}

void list_parts(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Output& output,
                Counters* counters) {
    const auto n = static_cast<std::size_t>(scene.triangles[0]);
    Launch{stream, geometry.blocks(n), geometry.threads}(parts_kernel, n, output, counters);
}

void fill_buckets(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const List<Hit>& hits,
                  const Output& output) {
    const auto second = static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
    Launch{stream, geometry.blocks(hits.capacity), geometry.threads}(bucket_kernel, hits, second, output);
}

void clear_flags(Clearing& clearing, const Scene& scene, const Output& output) {
    clearing.add(output.hit, whole_words(static_cast<std::size_t>(scene.triangles[0])));
    if (scene.between) clearing.add(output.hit_second, whole_words(static_cast<std::size_t>(scene.triangles[1])));
}

void order_buckets(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Output& output,
                   Counters* counters, Counters* told) {
    const auto n = static_cast<std::size_t>(scene.triangles[0]);
    Launch{stream, geometry.blocks(output.capacity), geometry.threads, sizeof(PartShared)}(
        order_kernel, n, scene.between, output, counters);
    Launch{stream, geometry.blocks(32 * part_capacity(output.capacity)), geometry.threads}(merge_kernel, n, output,
                                                                                           counters, told);
}

}  // namespace crumple::cuda
