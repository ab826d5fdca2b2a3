#pragma once

// Rows of several results of an overlap query, joined to one result.

#include <type_traits>

#include "crumple/overlaps.h"
#include "results/overlap_arrays.h"

namespace crumple::test {

struct JoinedRows {
    Overlaps result;

    /// Appends all rows. Does not append lists by world or body, nor skipped bodies.
    void add(const Overlaps& rows) {
        const auto depths = static_cast<std::int64_t>(result.depths.size()),
                   regions = static_cast<std::int64_t>(result.region_volume.size());
        for_each_overlap_array([&](const char*, auto array, OverlapLevel list) {
            if (list == OverlapLevel::worlds || list == OverlapLevel::skipped || list == OverlapLevel::bodies) return;
            append(rows.*array, list == OverlapLevel::offsets, result.*array);
        });
        for (std::size_t i = result.deepest.size() - rows.deepest.size(); i < result.deepest.size(); ++i)
            if (result.deepest[i] >= 0) result.deepest[i] += depths;
        for (std::size_t i = result.curve_regions.size() - rows.curve_regions.size(); i < result.curve_regions.size();
             ++i)
            if (result.curve_regions[i] >= 0) result.curve_regions[i] += regions;
        result.any = result.any || rows.any;
        result.count += static_cast<std::int64_t>(rows.bodies.size());
    }

   private:
    template <class T>
    static void append(const Array<T>& from, bool offsets, Array<T>& to) {
        const std::size_t skipped = offsets && !to.empty() ? 1 : 0, size = to.size();
        for (std::size_t i = skipped; i < from.size(); ++i) to.push_back(from[i]);
        if constexpr (std::is_same_v<T, std::int64_t>) {
            if (offsets && !from.empty() && from[0] != 0) to[0] = -1;  // offsets of a block begin at 0
            if (skipped == 1)
                for (std::size_t i = size; i < to.size(); ++i) to[i] += to[size - 1];
        }
    }
};

}  // namespace crumple::test
