#include "engine/cuda/output.h"

#include <cub/device/device_scan.cuh>

namespace crumple::cuda {
namespace {

constexpr unsigned short_row = 64;  ///< pairs of a first triangle that each find their place by looking at all others

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

std::size_t output_scratch_bytes(std::int64_t first_triangles) {
    std::size_t bytes = 0;
    unsigned long long* none = nullptr;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(nullptr, bytes, none, none, static_cast<std::size_t>(first_triangles) + 1));
    return bytes;
}

std::size_t whole_words(std::size_t flags) { return (flags + 3) / 4 * 4; }

std::size_t long_row_capacity(std::size_t pairs) { return pairs / short_row + 1; }

void make_offsets(cudaStream_t stream, const Scene& scene, const Output& output) {
    std::size_t bytes = output.scan_bytes;
    CRUMPLE_CUDA(cub::DeviceScan::ExclusiveSum(output.scan, bytes, output.offsets, output.offsets,
                                               static_cast<std::size_t>(scene.triangles[0]) + 1, stream));
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
