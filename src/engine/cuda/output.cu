#include "engine/cuda/output.h"

#include <algorithm>

#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>

namespace crumple::cuda {
namespace {

constexpr unsigned short_row = 64;  ///< pairs of a first triangle that each find their place by looking at all others

constexpr int offset_threads = 256, offsets_a_thread = offset_tile / offset_threads;

struct OffsetsShared {
    cub::BlockReduce<unsigned long long, offset_threads>::TempStorage sum;
    cub::BlockScan<unsigned long long, offset_threads>::TempStorage scan;
    unsigned long long before;  // pairs of all tiles that come first
};

// Prefix sums in one kernel: tiles were counted beside the triangles, so a block learns where its tile begins without
// waiting for another block. That it reads the numbers of all tiles before is little: there is one for 2,048 triangles.
__global__ void offsets_kernel(std::size_t n, Output out) {
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

__global__ void order_kernel(std::size_t n, bool between, Output out, Counters* counters) {
    const unsigned long long total = out.total(n);
    for (unsigned long long i = grid_thread(); i < total; i += grid_stride()) {
        const std::size_t a = segment_of(i, out.offsets, n);
        const unsigned long long begin = out.offsets[a], end = out.offsets[a + 1];
        const std::int32_t b = out.second[i];
        flag(out.hit, a);
        flag(between ? out.hit_second : out.hit, static_cast<std::size_t>(b));
        if (end - begin > short_row) {
            if (i != begin) continue;
            const unsigned long long place = atomicAdd(&counters->long_rows, 1ull);
            if (place < out.long_capacity) out.long_rows[place] = static_cast<std::int32_t>(a);
            continue;
        }
        unsigned long long rank = 0;
        for (unsigned long long j = begin; j < end; ++j) rank += out.second[j] < b;
        out.pairs[begin + rank] = {static_cast<std::int32_t>(a), b};
    }
}

// A block a row: Batcher's bitonic merge sort, in the form that always puts the smaller one first, so that any length
// will do: what lies behind the end counts as infinite and never moves. It is a pass's last kernel, so all counters
// have their values, and the first block tells the host.
__global__ void long_row_kernel(Output out, const Counters* counters, Counters* told) {
    if (told && blockIdx.x == 0 && threadIdx.x == 0) *told = *counters;
    const unsigned long long rows = min(counters->long_rows, out.long_capacity);
    for (unsigned long long r = blockIdx.x; r < rows; r += gridDim.x) {
        const std::int32_t a = out.long_rows[r];
        const unsigned long long begin = out.offsets[a], end = out.offsets[a + 1];
        const unsigned long long n = end - begin;
        std::int32_t* second = out.second + begin;
        for (unsigned long long size = 2; size / 2 < n; size *= 2) {
            for (unsigned long long stride = size / 2; stride > 0; stride /= 2) {
                for (unsigned long long i = threadIdx.x; i < n; i += blockDim.x) {
                    // The first step of a merge compares mirror images, the others neighbours at a stride.
                    const unsigned long long j = stride == size / 2 ? i ^ (size - 1) : i ^ stride;
                    if (j <= i || j >= n || second[i] <= second[j]) continue;
                    const std::int32_t swap = second[i];
                    second[i] = second[j];
                    second[j] = swap;
                }
                __syncthreads();
            }
        }
        for (unsigned long long i = threadIdx.x; i < n; i += blockDim.x) out.pairs[begin + i] = {a, second[i]};
    }
}

}  // namespace

std::size_t offset_tiles(std::size_t first_triangles) { return first_triangles / offset_tile + 1; }

std::size_t whole_words(std::size_t flags) { return (flags + 3) / 4 * 4; }

std::size_t long_row_capacity(std::size_t pairs) { return pairs / short_row + 1; }

void make_offsets(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Output& output) {
    const auto n = static_cast<std::size_t>(scene.triangles[0]);
    const auto blocks = static_cast<unsigned>(std::min<std::size_t>(offset_tiles(n), geometry.resident));
    Launch{stream, blocks, offset_threads, sizeof(OffsetsShared)}(offsets_kernel, n, output);
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
    Launch{stream, geometry.blocks(output.capacity), geometry.threads}(order_kernel, n, scene.between, output,
                                                                       counters);
    // A row is one block's, so that a large block helps.
    Launch{stream, geometry.blocks(32 * long_row_capacity(output.capacity)), 4 * geometry.threads}(
        long_row_kernel, output, counters, told);
}

}  // namespace crumple::cuda
