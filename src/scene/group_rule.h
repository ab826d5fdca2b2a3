#pragma once

// Which pairs of groups a query wants. Compiled for host and device.

#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

struct WantedGroups {
    bool between = false, within = false;     ///< groups that differ only, groups that are equal only
    const std::uint64_t* excluded = nullptr;  ///< keys of the pairs that are not wanted, sorted
    std::int64_t excluded_count = 0;
    friend bool operator==(const WantedGroups&, const WantedGroups&) = default;

    /// The lower group in the upper half.
    CRUMPLE_HD static std::uint64_t key(std::int32_t g, std::int32_t h) {
        const auto low = static_cast<std::uint32_t>(min(g, h)), high = static_cast<std::uint32_t>(max(g, h));
        return static_cast<std::uint64_t>(low) << 32 | high;
    }

    /// Every pair is: callers may skip the test.
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
