#include "results/overlap_rows.h"

#include <algorithm>
#include <array>

#include "results/overlap_arrays.h"

namespace crumple {
namespace {

/// Range of elements of a list that are copied, and the place of the first of them in the list that they are added to.
struct CopiedRange {
    std::size_t begin = 0, end = 0;
    std::int64_t place = 0;

    /// Converts an index into the copied list to one into the list that is added to. −1 stays −1.
    std::int64_t moved(std::int64_t index) const {
        return index < 0 ? index : index - static_cast<std::int64_t>(begin) + place;
    }
};
using CopiedRanges = std::array<CopiedRange, overlap_levels>;

CopiedRange& range_of(OverlapLevel list, CopiedRanges& ranges) { return ranges[static_cast<std::size_t>(list)]; }

// Appends the offsets of the parent's range, and returns the range of the list.
CopiedRange append_offsets(const Array<std::int64_t>& from, const CopiedRange& parent, Array<std::int64_t>& to) {
    if (from.empty()) return {};
    if (to.empty()) to.push_back(0);
    to.grow_by(parent.end - parent.begin);
    const std::int64_t first = from[parent.begin], place = to.back();
    for (std::size_t i = parent.begin; i < parent.end; ++i) to.push_back(from[i + 1] - first + place);
    return {static_cast<std::size_t>(first), static_cast<std::size_t>(from[parent.end]), place};
}

template <class T>
void append_range(const Array<T>& from, std::size_t begin, std::size_t end, Array<T>& to) {
    if (from.empty()) return;
    const std::size_t size = to.size();
    to.grow_by(end - begin);
    to.resize(size + (end - begin));
    std::copy(from.data() + begin, from.data() + end, to.data() + size);
}

bool is_of_rows(OverlapLevel list) {
    return list != OverlapLevel::worlds && list != OverlapLevel::skipped && list != OverlapLevel::bodies &&
           list != OverlapLevel::part_pairs;
}

}  // namespace

void append_rows(const Overlaps& from, std::size_t begin, std::size_t end, Overlaps& to) {
    if (begin == end) return;
    CopiedRanges ranges;
    range_of(OverlapLevel::rows, ranges) = {begin, end, static_cast<std::int64_t>(to.bodies.size())};
    for_each_overlap_list([&](OverlapLevel list, OverlapLevel parent, auto offsets) {
        range_of(list, ranges) = append_offsets(from.*offsets, range_of(parent, ranges), to.*offsets);
    });
    const std::size_t first_deepest = to.deepest.size(), first_curve = to.curve_regions.size();
    for_each_overlap_array([&](const char*, auto array, OverlapLevel list) {
        if (!is_of_rows(list) || list == OverlapLevel::offsets) return;
        // Some arrays have an element for each row and direction.
        const std::size_t each = list == OverlapLevel::rows ? (from.*array).size() / from.bodies.size() : 1;
        const CopiedRange& range = range_of(list, ranges);
        append_range(from.*array, each * range.begin, each * range.end, to.*array);
    });
    for (std::size_t i = first_deepest; i < to.deepest.size(); ++i)
        to.deepest[i] = range_of(OverlapLevel::depths, ranges).moved(to.deepest[i]);
    for (std::size_t i = first_curve; i < to.curve_regions.size(); ++i)
        to.curve_regions[i] = range_of(OverlapLevel::regions, ranges).moved(to.curve_regions[i]);
}

void deliver_in_blocks(const Overlaps& whole, const OverlapBlocks& blocks, Overlaps& block,
                       Cancellation& cancellation) {
    for_each_overlap_array([&](const char*, auto array, OverlapLevel list) {
        if (list == OverlapLevel::skipped || list == OverlapLevel::bodies) block.*array = whole.*array;
        if (list == OverlapLevel::offsets) (block.*array).assign((whole.*array).empty() ? 0 : 1, {});
    });
    block.any = whole.any;
    const std::size_t rows = whole.bodies.size(), most = static_cast<std::size_t>(blocks.most);
    for (std::size_t begin = 0; begin < rows; begin += std::min(rows - begin, most)) {
        cancellation.check();
        clear_rows(block);
        append_rows(whole, begin, begin + std::min(rows - begin, most), block);
        block.count = static_cast<std::int64_t>(begin + block.bodies.size());
        blocks.take(block);
    }
    if (rows == 0 && (!block.skipped.empty() || !block.body_volume.empty())) blocks.take(block);
}

void number_bodies(Overlaps& result, FunctionRef<std::int32_t(std::int32_t body)> number_of) {
    for (auto& [a, b] : result.bodies) a = number_of(a), b = number_of(b);
    for (auto* vertices : {&result.gradient_vertices, &result.depth_vertices, &result.winding_vertices})
        for (BodyVertex& vertex : *vertices) vertex.body = number_of(vertex.body);
}

void clear_rows(Overlaps& result) {
    for_each_overlap_array([&](const char*, auto array, OverlapLevel list) {
        if (!is_of_rows(list)) return;
        const bool keeps_first = list == OverlapLevel::offsets && !(result.*array).empty();
        (result.*array).resize(keeps_first ? 1 : 0);
    });
}

}  // namespace crumple
