#include "backends/cpu/stages/sort.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace crumple::cpu {
namespace {

std::int64_t blocks_of(std::int64_t members) {
    return std::max<std::int64_t>(1, (members + block_members - 1) / block_members);
}

constexpr int bin_bits = 10, bins = 1 << bin_bits, bin_shift = 16 - bin_bits;

// Writes a row whose box overlaps nothing.
void write_dummy(SortScratch& scratch, SortedLeaf& s, std::int64_t row) {
    constexpr std::uint16_t most = std::numeric_limits<std::uint16_t>::max();
    scratch.sorted_box[row] = {most, 0, most, 0};
    s.lower[row] = most;
    s.link[row] = {0, -1};
    if (!s.begin.empty()) s.begin[row] = 0;
}

int bin(std::uint16_t x) { return x >> bin_shift; }

using BinStarts = std::int32_t[bins + 1];

// Computes where each bin of the members [first, last) starts.
void count_bins(const QuantisedBox* box, std::int64_t first, std::int64_t last, BinStarts& start) {
    std::fill_n(start, bins + 1, 0);
    for (std::int64_t i = first; i < last; ++i) ++start[bin(box[i].low_x) + 1];
    start[0] = static_cast<std::int32_t>(first);
    for (int b = 0; b < bins; ++b) start[b + 1] += start[b];
}

// Sorts the members of one mesh (`side` 0 or 1) by a counting sort of their starts, and writes each member's data
// straight to its row. `own` and `other`: where the bins of this mesh and of the other one start. With a single mesh, a
// row's columns are the later rows, up to the bin of the row's end. Between two meshes, they are the members of the
// other mesh from the bin after that of the row's start to the bin of its end and, for a row of the first mesh, also
// those in the bin of its start. Returns the number of interval tests.
template <bool one_block, bool between>
std::int64_t place(const LeafMembers& in, int side, const BinStarts& own, const BinStarts& other, SortScratch& scratch,
                   SortedLeaf& s) {
    const QuantisedBox* boxes = scratch.box.data();
    const auto row_of = [](std::int32_t j) { return static_cast<std::int32_t>(one_block ? j : physical(j)); };
    std::int32_t next[bins];
    std::copy_n(own, bins, next);
    std::int64_t work = 0;
    for (std::int64_t i = own[0]; i < own[bins]; ++i) {
        const QuantisedBox& box = boxes[i];
        const int first_bin = bin(box.low_x), last_bin = bin(box.high_x);
        const std::int32_t row = row_of(next[first_bin]++);
        std::int32_t begin = row + 1;
        if constexpr (between) s.begin[row] = begin = row_of(other[first_bin + side]);
        const std::int32_t end = row_of(other[last_bin + 1] - 1) + 1;
        s.position[i] = row;
        scratch.sorted_box[row] = box.across;
        s.link[row] = {end, in.triangle[i]};
        s.lower[row] = in.lower[i];
        work += std::max(0, end - begin);
    }
    return work;
}

template <bool one_block>
std::int64_t place(const LeafMembers& in, SortScratch& scratch, SortedLeaf& s) {
    BinStarts start[2];
    if (!in.between) {
        count_bins(scratch.box.data(), 0, s.members, start[0]);
        return place<one_block, false>(in, 0, start[0], start[0], scratch, s);
    }
    count_bins(scratch.box.data(), 0, in.first_side, start[0]);
    count_bins(scratch.box.data(), in.first_side, s.members, start[1]);
    return place<one_block, true>(in, 0, start[0], start[1], scratch, s) +
           place<one_block, true>(in, 1, start[1], start[0], scratch, s);
}

}  // namespace

void reserve(std::int64_t members, bool between, SortScratch& scratch, SortedLeaf& s) {
    const auto n = static_cast<std::size_t>(members);
    scratch.box.resize_discard(n + padding);
    s.position.resize_discard(n + padding);
    s.members = members;
    s.rows = members + blocks_of(members);
    const auto length = static_cast<std::size_t>(s.rows + padding);
    for (auto* array : {&s.low_y, &s.high_y, &s.low_z, &s.high_z, &s.lower}) array->resize_discard(length);
    scratch.sorted_box.resize_discard(length);
    s.link.resize_discard(length);
    s.begin.resize_discard(between ? length : 0);
    s.member.resize_discard(length);
}

void sort_leaf(const LeafMembers& in, const StageKernels& kernels, SortScratch& scratch, SortedLeaf& s) {
    const LeafBounds& bounds = in.bounds;
    const auto members = in.size();
    // Chooses the range of quantisation. Margins of boxes are part of the bases: subtracting a larger base from starts
    // and a smaller one from ends moves starts down and ends up (docs/align.md).
    const bool any = bounds.low.x <= bounds.high.x;
    Quantisation by{};
    for (int axis = 0; axis < 3; ++axis) {
        const float low = any ? bounds.low[axis] : 0, high = any ? bounds.high[axis] : 1;
        const float margin = box_margin(bounds.reach);
        const float base = low - 2 * margin;
        by.base_low[axis] = base + margin;
        by.base_high[axis] = base - margin;
        by.scale[axis] = 65530.0f / (high - low + 4 * margin);
    }
    reserve(members, in.between, scratch, s);
    kernels.quantise(in.boxes, members, by, scratch.box.data());

    for_each_dummy(s, [&](std::int64_t row) { write_dummy(scratch, s, row); });
    s.work = members <= block_members ? place<true>(in, scratch, s) : place<false>(in, scratch, s);
    if (in.keep_members)
        for (std::int64_t i = 0; i < members; ++i) s.member[s.position[i]] = in.member[i];
    kernels.split_boxes(scratch.sorted_box.data(), s.rows, s);
}

}  // namespace crumple::cpu
