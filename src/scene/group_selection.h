#pragma once

// Filter of pairs of groups of triangles, by the scope and the excluded pairs of a PairFilter. Pairs of bodies are
// filtered in the same way. Compiled for host and device.

#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

struct GroupSelection {
    bool between = false, within = false;     ///< between: only different groups; within: only equal groups
    const std::uint64_t* excluded = nullptr;  ///< sorted keys of the excluded pairs
    std::int64_t excluded_count = 0;
    friend bool operator==(const GroupSelection&, const GroupSelection&) = default;

    /// Returns the key of a pair: the lower group in the upper 32 bits.
    CRUMPLE_HD static std::uint64_t key(std::int32_t g, std::int32_t h) {
        const auto low = static_cast<std::uint32_t>(min(g, h)), high = static_cast<std::uint32_t>(max(g, h));
        return static_cast<std::uint64_t>(low) << 32 | high;
    }

    /// True if every pair is selected: callers may skip the test.
    CRUMPLE_HD bool all() const { return !between && !within && excluded_count == 0; }

    CRUMPLE_HD bool operator()(std::int32_t g, std::int32_t h) const {
        if ((between && g == h) || (within && g != h)) return false;
        const std::uint64_t pair = key(g, h);
        std::int64_t begin = 0, end = excluded_count;
        while (begin < end) {
            const std::int64_t middle = (begin + end) / 2;
            if (excluded[middle] < pair)
                begin = middle + 1;
            else
                end = middle;
        }
        return begin == excluded_count || excluded[begin] != pair;
    }
};

}  // namespace crumple
