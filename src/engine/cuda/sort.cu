#include "engine/cuda/sort.h"

#include <algorithm>

#include <cub/device/device_scan.cuh>

#include "engine/cuda/align.h"

namespace crumple::cuda {
namespace {

__device__ std::uint32_t bin_of(float x, const Frame& frame) {
    const float b = (x - frame.base) * frame.scale;  // monotone, so overlapping intervals have overlapping bins
    return b > 0 ? (b < bins - 1 ? static_cast<std::uint32_t>(b) : bins - 1) : 0;
}

// First and last bin of each member, and its place among those that start in the same bin.
template <class T>
__global__ void bin_kernel(Scene scene, const Row<T>* rows, const unsigned long long* count, Members members,
                           const Frame* frames, Sorted sorted, unsigned* bin_count) {
    for (unsigned long long m = grid_thread(); m < *count; m += grid_stride()) {
        const std::int32_t t = members.triangle[m];
        const std::uint32_t leaf = members.child[m];
        const Frame& frame = frames[leaf];
        Vec3d p[3];
        load_corners(rows, scene.corners + 3 * static_cast<std::size_t>(t), p);
        const InFrame<3> member(p, frame);
        const std::uint32_t first = bin_of(member.low.x - frame.margin, frame);
        const std::uint32_t last = bin_of(member.high.x + frame.margin, frame);
        sorted.bin[m] = first | last << 16;
        sorted.rank[m] = atomicAdd(&bin_count[leaf * bins + first], 1u);
    }
}

// Units of each group of 32 rows; a group is a warp's.
__global__ void unit_kernel(const unsigned long long* count, std::size_t groups, Sorted sorted) {
    const unsigned lane = threadIdx.x % 32;
    for (std::size_t group = grid_thread() / 32; group < groups; group += grid_stride() / 32) {
        const unsigned long long row = 32 * group + lane;
        std::uint32_t end = row < *count ? sorted.end[row] : 0;
        for (int lanes = 16; lanes > 0; lanes /= 2) end = max(end, __shfl_xor_sync(whole_warp, end, lanes));
        if (lane != 0) continue;
        const auto first = static_cast<std::uint32_t>(32 * group) + 1;
        sorted.group_end[group] = end;
        sorted.unit_first[group] = end > first ? (end - first + unit_columns - 1) / unit_columns : 0;
    }
}

template <class In>
std::size_t scan_bytes(In data, std::size_t n) {
    std::size_t bytes = 0;
    CRUMPLE_CUDA(cub::DeviceScan::ExclusiveSum(nullptr, bytes, data, data, n));
    return bytes;
}

std::size_t groups_of(std::size_t capacity) { return (capacity + 31) / 32; }

}  // namespace

void clear(Clearing& clearing, const Sorted& sorted, int leaves) {
    clearing.add(sorted.bin_first, (static_cast<std::size_t>(leaves) * bins + 1) * sizeof *sorted.bin_first);
}

std::size_t sort_scratch_bytes(int leaves, std::size_t capacity) {
    return std::max(scan_bytes(static_cast<std::uint32_t*>(nullptr), static_cast<std::size_t>(leaves) * bins + 1),
                    scan_bytes(static_cast<unsigned long long*>(nullptr), groups_of(capacity) + 1));
}

void bin_members(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Points& points, int leaves,
                 const unsigned long long* first, const Members& members, const Frame* frames, const Sorted& sorted,
                 const SortScratch& scratch) {
    const auto bin_total = static_cast<std::size_t>(leaves) * bins + 1;
    const Launch over_members{stream, geometry.blocks(members.capacity), geometry.threads};
    const auto count = [&](const auto* rows, auto kernel) {
        over_members(kernel, scene, rows, first + leaves, members, frames, sorted, sorted.bin_first);
    };
    if (points.f)
        count(points.f, bin_kernel<float>);
    else
        count(points.d, bin_kernel<double>);
    std::size_t bytes = scratch.scan_bytes;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(scratch.scan, bytes, sorted.bin_first, sorted.bin_first, bin_total, stream));
}

void count_units(const Geometry& geometry, cudaStream_t stream, const unsigned long long* count, std::size_t capacity,
                 const Sorted& sorted, const SortScratch& scratch) {
    // One group more, so that the scan ends with the total.
    const std::size_t groups = groups_of(capacity) + 1;
    Launch{stream, geometry.blocks(32 * groups), geometry.threads}(unit_kernel, count, groups, sorted);
    std::size_t bytes = scratch.scan_bytes;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(scratch.scan, bytes, sorted.unit_first, sorted.unit_first, groups, stream));
}

}  // namespace crumple::cuda
