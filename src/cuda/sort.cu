#include "cuda/sort.h"

#include <algorithm>

#include <cub/device/device_scan.cuh>

#include "cuda/align.h"

namespace crumple::cuda {
namespace {

constexpr float plane_bound = 28;  // planes are scaled by 1 / (28 u reach): the error of n . p - c (docs/narrow.md)

__device__ std::uint32_t bin_of(float x, const Frame& frame) {
    const float b = (x - frame.base) * frame.scale;  // monotone, so overlapping intervals have overlapping bins
    return b > 0 ? (b < bins - 1 ? static_cast<std::uint32_t>(b) : bins - 1) : 0;
}

template <class T>
struct Corners {
    Row<T> p[3];
    Vec3f q[3];  ///< relative to the frame's origin
};
template <class T>
__device__ Corners<T> corners_of(const Scene& scene, const Row<T>* rows, std::int32_t triangle, Vec3f origin) {
    const std::int32_t* corner = scene.corners + 3 * static_cast<std::size_t>(triangle);
    Corners<T> c;
    for (int k = 0; k < 3; ++k) {
        c.p[k] = rows[corner[k]];
        c.q[k] = relative(c.p[k], origin);
    }
    return c;
}

// First and last bin of each member, and its place among those that start in the same bin.
template <class T>
__global__ void bin_kernel(Scene scene, const Row<T>* rows, const Ball* balls, const unsigned long long* count,
                           Members members, const Frame* frames, Sorted sorted, unsigned* bin_count) {
    for (unsigned long long m = grid_thread(); m < *count; m += grid_stride()) {
        const std::int32_t t = members.triangle[m];
        const std::uint32_t leaf = members.child[m];
        const Frame& frame = frames[leaf];
        const float reach = reach_of(balls[t], frame);
        const Corners<T> c = corners_of(scene, rows, t, frame.origin);
        const Interval x = extent(c.q, frame.axis[0], margin_of(reach, frame));
        const std::uint32_t first = bin_of(x.low, frame), last = bin_of(x.high, frame);
        sorted.bin[m] = first | last << 16;
        sorted.rank[m] = atomicAdd(&bin_count[leaf * bins + first], 1u);
    }
}

// The plane of a triangle in its leaf, and the corners that the filters read.
template <class T>
__device__ Record record_of(const Corners<T>& c, const std::int32_t* id, float reach, const Frame& frame) {
    const float scale = 1.0f / (plane_bound * unit_roundoff * frame.reach + 1e-30f);
    Record record;
    for (int k = 0; k < 3; ++k) {
        record.x[k] = c.q[k].x, record.y[k] = c.q[k].y, record.z[k] = c.q[k].z;
        record.id[k] = id[k];
    }
    Vec3f n;
    if (reach > frame.big) {
        const auto difference = [&](int k) {
            return Vec3d{static_cast<double>(c.p[k].x) - c.p[0].x, static_cast<double>(c.p[k].y) - c.p[0].y,
                         static_cast<double>(c.p[k].z) - c.p[0].z};
        };
        const Vec3d a = difference(1), b = difference(2);
        const double sum = (std::abs(a.y * b.z) + std::abs(a.z * b.y)) + (std::abs(a.z * b.x) + std::abs(a.x * b.z)) +
                           (std::abs(a.x * b.y) + std::abs(a.y * b.x)) + 1e-30;
        const Vec3d normal = (1 / sum) * cross(a, b);
        const Vec3d p{static_cast<double>(c.p[0].x) - frame.origin.x, static_cast<double>(c.p[0].y) - frame.origin.y,
                      static_cast<double>(c.p[0].z) - frame.origin.z};
        n = {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)};
        record.c = static_cast<float>(dot(normal, p)) * scale;
        for (int k = 0; k < 3; ++k) record.x[k] = record.y[k] = record.z[k] = NAN;
    } else {
        const auto difference = [&](int k) {
            return Vec3f{static_cast<float>(c.p[k].x - c.p[0].x), static_cast<float>(c.p[k].y - c.p[0].y),
                         static_cast<float>(c.p[k].z - c.p[0].z)};
        };
        const Vec3f a = difference(1), b = difference(2);
        const float sum = (std::abs(a.y * b.z) + std::abs(a.z * b.y)) + (std::abs(a.z * b.x) + std::abs(a.x * b.z)) +
                          (std::abs(a.x * b.y) + std::abs(a.y * b.x)) + 1e-30f;
        const Vec3f normal = cross(a, b);
        n = {normal.x / sum, normal.y / sum, normal.z / sum};
        record.c = dot(n, c.q[0]) * scale;
    }
    record.x[3] = n.x * scale, record.y[3] = n.y * scale, record.z[3] = n.z * scale;
    return record;
}

template <class T>
__global__ void place_kernel(Scene scene, const Row<T>* rows, const Ball* balls, const unsigned long long* count,
                             Members members, const Frame* frames, Ownership ownership, Sorted sorted,
                             Counters* counters) {
    unsigned long long tests = 0;
    for (unsigned long long m = grid_thread(); m < *count; m += grid_stride()) {
        const std::int32_t t = members.triangle[m];
        const std::uint32_t leaf = members.child[m], bin = sorted.bin[m];
        const std::uint32_t row = sorted.bin_first[leaf * bins + (bin & 0xffff)] + sorted.rank[m];
        const std::uint32_t end = sorted.bin_first[leaf * bins + (bin >> 16) + 1];
        const Frame& frame = frames[leaf];
        const float reach = reach_of(balls[t], frame), margin = margin_of(reach, frame);
        const Corners<T> c = corners_of(scene, rows, t, frame.origin);
        const Interval y = extent(c.q, frame.axis[1], margin), z = extent(c.q, frame.axis[2], margin);
        const auto item = members.item[m];
        const auto child = leaf % static_cast<std::uint32_t>(ownership.last_fan_out);
        const std::uint64_t lower = ownership.last_mask[item] & ((std::uint64_t{1} << child) - 1);
        const std::uint64_t side = scene.between ? std::uint64_t{1} << (max_fan_out + scene.second(t)) : 0;
        sorted.box[row] = {y.low, y.high, z.low, z.high};
        sorted.record[row] = record_of(c, scene.corners + 3 * static_cast<std::size_t>(t), reach, frame);
        sorted.conflict[row] = lower | side;
        sorted.end[row] = end;
        sorted.triangle[row] = t;
        sorted.leaf[row] = static_cast<std::uint16_t>(leaf);
        tests += end - row - 1;
    }
    if (tests) atomicAdd(&counters->interval_tests, tests);
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
void place(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Row<T>* rows, const Ball* balls,
           int leaves, const unsigned long long* first, const Members& members, const Frame* frames,
           const Ownership& ownership, const Sorted& sorted, const SortScratch& scratch, Counters* counters) {
    const auto bin_total = static_cast<std::size_t>(leaves) * bins + 1;
    const unsigned long long* count = first + leaves;
    const Launch over_members{stream, geometry.blocks(members.capacity), geometry.threads};
    CRUMPLE_CUDA(cudaMemsetAsync(sorted.bin_first, 0, bin_total * sizeof *sorted.bin_first, stream));
    over_members(bin_kernel<T>, scene, rows, balls, count, members, frames, sorted, sorted.bin_first);
    std::size_t bytes = scratch.scan_bytes;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(scratch.scan, bytes, sorted.bin_first, sorted.bin_first, bin_total, stream));
    over_members(place_kernel<T>, scene, rows, balls, count, members, frames, ownership, sorted, counters);
}

}  // namespace

std::size_t sort_scratch_bytes(int leaves, std::size_t capacity) {
    return std::max(scan_bytes(static_cast<std::uint32_t*>(nullptr), static_cast<std::size_t>(leaves) * bins + 1),
                    scan_bytes(static_cast<unsigned long long*>(nullptr), groups_of(capacity) + 1));
}

void sort_members(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Points& points,
                  const Ball* balls, int leaves, const unsigned long long* first, const Members& members,
                  const Frame* frames, const Ownership& ownership, const Sorted& sorted, const SortScratch& scratch,
                  Counters* counters) {
    if (points.f)
        place(geometry, stream, scene, points.f, balls, leaves, first, members, frames, ownership, sorted, scratch,
              counters);
    else
        place(geometry, stream, scene, points.d, balls, leaves, first, members, frames, ownership, sorted, scratch,
              counters);
    // One group more, so that the scan ends with the total.
    const std::size_t groups = groups_of(members.capacity) + 1;
    Launch{stream, geometry.blocks(32 * groups), geometry.threads}(unit_kernel, first + leaves, groups, sorted);
    std::size_t bytes = scratch.scan_bytes;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(scratch.scan, bytes, sorted.unit_first, sorted.unit_first, groups, stream));
}

}  // namespace crumple::cuda
