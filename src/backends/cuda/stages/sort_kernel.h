#pragma once

// Kernel of `sort` that places members and writes their records. Each kind of query includes this file and instantiates
// sort_members() for its records.

#include "backends/cuda/device/block_counter.h"
#include "backends/cuda/stages/align.h"
#include "backends/cuda/stages/sort.h"

namespace crumple::cuda {
namespace detail {

// Makes box and record of each member from one gather of its corners.
template <class T, class Primitive, class Records>
__global__ void place_kernel(PreparedScene scene, const Row<T>* rows, int leaves, Segments members_of, Members members,
                             Frames frames, Ownership ownership, Sorted sorted, Primitive primitive, Records records,
                             Counters* counters) {
    unsigned long long tests = 0;
    const auto n = static_cast<std::size_t>(leaves);
    for (unsigned long long m = grid_thread(); m < members_of.first[n]; m += grid_stride()) {
        const auto leaf = static_cast<std::uint32_t>(segment_of(m, members_of.first, n));
        if (m >= members_of.end(leaf)) continue;
        const std::int32_t t = members.triangle[m];
        const std::uint32_t bin = sorted.bin[m], *bin_first = sorted.bin_first + leaf * (bins + 1);
        const std::uint32_t row = bin_first[bin & 0xffff] + sorted.rank[m], end = bin_first[(bin >> 16) + 1];
        const Frame frame = frames[leaf];
        const std::int32_t* corner = scene.corners + 3 * static_cast<std::size_t>(t);
        Vec3d p[Primitive::corners];
        const auto member = primitive.in_frame(rows, corner, t, frame, p);
        const auto item = members.item[m];
        const auto child = leaf % static_cast<std::uint32_t>(ownership.last_fan_out);
        const std::uint64_t lower = ownership.last_mask[item] & ((std::uint64_t{1} << child) - 1);
        const std::uint64_t side = scene.between ? std::uint64_t{1} << (max_fan_out_between - 1 + scene.second(t)) : 0;
        sorted.row[row] = {{member.low.y - frame.margin, member.high.y + frame.margin, member.low.z - frame.margin,
                            member.high.z + frame.margin},
                           lower | side,
                           end,
                           t};
        records.put(row, t, p, corner, member, frame);
        sorted.leaf[row] = static_cast<std::uint16_t>(leaf);
        tests += end - row - 1;
    }
    add_by_block(tests, &counters->interval_tests, dynamic_shared<BlockShared>());
}

}  // namespace detail

template <class Primitive, class Records>
void sort_members(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Points& points,
                  int leaves, const Segments& members_of, const Members& members, const Frames& frames,
                  const Ownership& ownership, const Sorted& sorted, const Primitive& primitive, const Records& records,
                  const List<SweepUnit>& units, Counters* counters) {
    bin_members(geometry, stream, scene, primitive, points, leaves, members_of, members, frames, sorted);
    const auto place = [&](const auto* rows, auto kernel) {
        Launch{stream, geometry.blocks(members.capacity), geometry.threads, sizeof(BlockShared)}(
            kernel, scene, rows, leaves, members_of, members, frames, ownership, sorted, primitive, records, counters);
    };
    if (points.f)
        place(points.f, detail::place_kernel<float, Primitive, Records>);
    else
        place(points.d, detail::place_kernel<double, Primitive, Records>);
    list_units(geometry, stream, leaves, members_of, members.capacity, sorted, units);
}

}  // namespace crumple::cuda
