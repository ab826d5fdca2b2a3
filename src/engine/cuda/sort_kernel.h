#pragma once

// The kernel of `sort` that places members, for those who keep something of each: a question includes this and
// instantiates sort_members<Records>().

#include "engine/cuda/align.h"
#include "engine/cuda/sort.h"

namespace crumple::cuda {
namespace detail {

// Box and record are made from one gather of the corners.
template <class T, class Records>
__global__ void place_kernel(Scene scene, const Row<T>* rows, const unsigned long long* count, Members members,
                             const Frame* frames, Ownership ownership, Sorted sorted, Records records,
                             Counters* counters) {
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
        const auto item = members.item[m];
        const auto child = leaf % static_cast<std::uint32_t>(ownership.last_fan_out);
        const std::uint64_t lower = ownership.last_mask[item] & ((std::uint64_t{1} << child) - 1);
        const std::uint64_t side = scene.between ? std::uint64_t{1} << (max_fan_out_between - 1 + scene.second(t)) : 0;
        sorted.box[row] = {member.low.y - frame.margin, member.high.y + frame.margin, member.low.z - frame.margin,
                           member.high.z + frame.margin};
        records.put(row, p, corner, member, frame);
        sorted.conflict[row] = lower | side;
        sorted.end[row] = end;
        sorted.triangle[row] = t;
        sorted.leaf[row] = static_cast<std::uint16_t>(leaf);
        tests += end - row - 1;
    }
    for (int lanes = 16; lanes > 0; lanes /= 2) tests += __shfl_xor_sync(whole_warp, tests, lanes);
    if (tests && threadIdx.x % 32 == 0) atomicAdd(&counters->interval_tests, tests);
}

}  // namespace detail

template <class Records>
void sort_members(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Points& points, int leaves,
                  const unsigned long long* first, const Members& members, const Frame* frames,
                  const Ownership& ownership, const Sorted& sorted, const Records& records, const SortScratch& scratch,
                  Counters* counters) {
    bin_members(geometry, stream, scene, points, leaves, first, members, frames, sorted, scratch);
    const unsigned long long* count = first + leaves;
    const auto place = [&](const auto* rows, auto kernel) {
        Launch{stream, geometry.blocks(members.capacity), geometry.threads}(kernel, scene, rows, count, members, frames,
                                                                            ownership, sorted, records, counters);
    };
    if (points.f)
        place(points.f, detail::place_kernel<float, Records>);
    else
        place(points.d, detail::place_kernel<double, Records>);
    count_units(geometry, stream, count, members.capacity, sorted, scratch);
}

}  // namespace crumple::cuda
