#pragma once

// Comparison of complete results: pairs as sets, so that a failure lists them, everything else byte by byte.

#include <gtest/gtest.h>

#include <cctype>
#include <cstring>
#include <span>
#include <string_view>

#include "crumple/crumple.h"
#include "soups.h"
#include "tested_backend.h"

namespace crumple::test {

inline testing::AssertionResult same_pairs(std::span<const Pair> found, std::span<const Pair> expected) {
    const std::string text = difference({expected.begin(), expected.end()}, {found.begin(), found.end()});
    return text.empty() ? testing::AssertionSuccess() : testing::AssertionFailure() << text;
}

template <class T>
testing::AssertionResult same_bytes(const Array<T>& found, const Array<T>& expected, const char* what) {
    if (found.size() != expected.size())
        return testing::AssertionFailure() << found.size() << ' ' << what << " instead of " << expected.size();
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::memcmp(&found[i], &expected[i], sizeof(T)) != 0)
            return testing::AssertionFailure() << what << " differ at " << i;
    }
    return testing::AssertionSuccess();
}

/// Compares complete results. Of the statistics, it compares only rational_contacts, which does not depend on backend
/// and options.
inline testing::AssertionResult same_result(const Intersections& found, const Intersections& expected) {
    testing::AssertionResult same = same_pairs(found.pairs.span(), expected.pairs.span());
    if (same) same = same_bytes(found.offsets, expected.offsets, "offsets");
    if (same) same = same_bytes(found.hit, expected.hit, "hit flags");
    if (same) same = same_bytes(found.hit_second, expected.hit_second, "hit flags of the second mesh");
    if (same) same = same_bytes(found.contacts.kinds, expected.contacts.kinds, "contact kinds");
    if (same) same = same_bytes(found.contacts.offsets, expected.contacts.offsets, "contact offsets");
    if (same) same = same_bytes(found.contacts.points, expected.contacts.points, "contact points");
    const std::int64_t rational = found.statistics.rational_contacts,
                       expected_rational = expected.statistics.rational_contacts;
    if (same && rational != expected_rational)
        same = testing::AssertionFailure()
               << rational << " contacts in rational arithmetic instead of " << expected_rational;
    return same;
}

/// Replaces characters that GoogleTest does not allow in names by underscores.
inline std::string test_name(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    return text;
}

}  // namespace crumple::test
