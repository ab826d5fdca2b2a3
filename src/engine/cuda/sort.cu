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

template <class T>
__global__ void place_kernel(Scene scene, const Row<T>* rows, const unsigned long long* count, Members members,
                             const Frame* frames, Ownership ownership, Sorted sorted, Counters* counters) {
    unsigned long long tests = 0;
    for (unsigned long long m = grid_thread(); m < *count; m += grid_stride()) {
        const std::int32_t t = members.triangle[m];
        const std::uint32_t leaf = members.child[m], bin = sorted.bin[m];
        const std::uint32_t row = sorted.bin_first[leaf * bins + (bin & 0xffff)] + sorted.rank[m];
        const std::uint32_t end = sorted.bin_first[leaf * bins + (bin >> 16) + 1];
        const Frame& frame = frames[leaf];
        const std::int32_t* corner = scene.corners + 3 * static_cast<std::size_t>(t);
        Vec3d p[3];
        load_corners(rows, corner, p);
        const InFrame<3> member(p, frame);
        Record record = record_of(p, corner, member);
        scale_plane(record, plane_scale(frame.reach));
        const auto item = members.item[m];
        const auto child = leaf % static_cast<std::uint32_t>(ownership.last_fan_out);
        const std::uint64_t lower = ownership.last_mask[item] & ((std::uint64_t{1} << child) - 1);
        const std::uint64_t side = scene.between ? std::uint64_t{1} << (max_fan_out_between - 1 + scene.second(t)) : 0;
        sorted.box[row] = {member.low.y - frame.margin, member.high.y + frame.margin, member.low.z - frame.margin,
                           member.high.z + frame.margin};
        sorted.record[row] = record;
        sorted.conflict[row] = lower | side;
        sorted.end[row] = end;
        sorted.triangle[row] = t;
        sorted.leaf[row] = static_cast<std::uint16_t>(leaf);
        tests += end - row - 1;
    }
    for (int lanes = 16; lanes > 0; lanes /= 2) tests += __shfl_xor_sync(whole_warp, tests, lanes);
    if (tests && threadIdx.x % 32 == 0) atomicAdd(&counters->interval_tests, tests);
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

template <class T>
void place(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Row<T>* rows, int leaves,
           const unsigned long long* first, const Members& members, const Frame* frames, const Ownership& ownership,
           const Sorted& sorted, const SortScratch& scratch, Counters* counters) {
    const auto bin_total = static_cast<std::size_t>(leaves) * bins + 1;
    const unsigned long long* count = first + leaves;
    const Launch over_members{stream, geometry.blocks(members.capacity), geometry.threads};
    over_members(bin_kernel<T>, scene, rows, count, members, frames, sorted, sorted.bin_first);
    std::size_t bytes = scratch.scan_bytes;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(scratch.scan, bytes, sorted.bin_first, sorted.bin_first, bin_total, stream));
    over_members(place_kernel<T>, scene, rows, count, members, frames, ownership, sorted, counters);
}

}  // namespace

void clear(Clearing& clearing, const Sorted& sorted, int leaves) {
    clearing.add(sorted.bin_first, (static_cast<std::size_t>(leaves) * bins + 1) * sizeof *sorted.bin_first);
}

std::size_t sort_scratch_bytes(int leaves, std::size_t capacity) {
    return std::max(scan_bytes(static_cast<std::uint32_t*>(nullptr), static_cast<std::size_t>(leaves) * bins + 1),
                    scan_bytes(static_cast<unsigned long long*>(nullptr), groups_of(capacity) + 1));
}

void sort_members(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Points& points, int leaves,
                  const unsigned long long* first, const Members& members, const Frame* frames,
                  const Ownership& ownership, const Sorted& sorted, const SortScratch& scratch, Counters* counters) {
    if (points.f)
        place(geometry, stream, scene, points.f, leaves, first, members, frames, ownership, sorted, scratch, counters);
    else
        place(geometry, stream, scene, points.d, leaves, first, members, frames, ownership, sorted, scratch, counters);
    // One group more, so that the scan ends with the total.
    const std::size_t groups = groups_of(members.capacity) + 1;
    Launch{stream, geometry.blocks(32 * groups), geometry.threads}(unit_kernel, first + leaves, groups, sorted);
    std::size_t bytes = scratch.scan_bytes;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(scratch.scan, bytes, sorted.unit_first, sorted.unit_first, groups, stream));
}

}  // namespace crumple::cuda
