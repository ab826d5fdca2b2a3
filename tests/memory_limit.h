#pragma once

// Search for a sufficient memory limit by doubling, as docs/memory.md recommends, and comparison of results under it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "crumple/detector.h"

namespace crumple::test {

/// Returns a memory limit, at least options.memory_limit, under which call(Detector&) succeeds. Each of `halvings`
/// bisection steps moves it closer to the smallest such limit. Expects bytes_needed of every earlier error to be a
/// lower bound of that limit.
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

/// Expects find(Detector&) on the cpu backend to return the same result twice in a row under a limit near the smallest
/// sufficient one, and to stay within that limit. difference(a, b) returns a string, empty if two results are equal.
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
