#pragma once

// Memory limits that suffice, found by doubling, as docs/memory.md recommends, and results under them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "crumple/detector.h"

namespace crumple::test {

/// Returns a limit, from options.memory_limit on, under which call(Detector&) succeeds; with `halvings`, one that is
/// that much closer to the least. Expects what errors name on the way to be true lower bounds.
template <class Call>
std::int64_t sufficient_limit(Options options, Call call, int halvings = 0) {
    std::int64_t named = 0, too_small = 0;
    const auto suffices = [&](std::int64_t limit) {
        options.memory_limit = limit;
        Detector detector(options);
        try {
            call(detector);
            return true;
        } catch (const Error& error) {
            if (error.code != ErrorCode::memory_limit || error.bytes_needed <= limit) throw;
            named = std::max(named, error.bytes_needed);
            too_small = std::max(too_small, limit);
            return false;
        }
    };
    std::int64_t limit = std::max<std::int64_t>(options.memory_limit, 1);
    while (!suffices(limit)) limit = std::max(2 * limit, named);
    for (; halvings > 0; --halvings)
        if (const std::int64_t middle = too_small + (limit - too_small) / 2; suffices(middle)) limit = middle;
    EXPECT_LE(named, limit) << "no lower bound: less suffices";
    return limit;
}

/// Expects find(Detector&) of the cpu backend to return the same under a limit near the least one, twice in a row, and
/// to stay within it; difference(a, b) is a string, which is empty if two results are the same.
template <class Find, class Difference>
void expect_same_under_limit(Find find, Difference difference) {
    Options options{.backend = Backend::cpu, .threads = 1};
    Detector unlimited(options);
    const auto expected = find(unlimited);
    const auto find_as_expected = [&](Detector& detector) { EXPECT_EQ(difference(find(detector), expected), ""); };
    options.memory_limit = sufficient_limit(options, find_as_expected, 4);
    Detector limited(options);
    const auto found = find(limited);
    EXPECT_EQ(difference(found, expected), "");
    EXPECT_LE(found.statistics.peak_memory_bytes, options.memory_limit);
    EXPECT_EQ(difference(find(limited), expected), "") << "again";
}

}  // namespace crumple::test
