#pragma once

// Comparison of results of the cuda and the cpu backend: a wrong result of the cuda backend is recorded in its row of
// figures, and the run goes on.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace crumple::benchmark {

/// Returns a sentence about the first difference of an array `found` by the cuda backend from the array `expected` of
/// the cpu backend; empty if they are equal.
template <class Found, class Expected>
std::string array_difference(std::string_view name, const Found& found, const Expected& expected) {
    const auto [place, other] = std::mismatch(found.begin(), found.end(), expected.begin(), expected.end());
    if (place == found.end() && other == expected.end()) return "";
    return fmt::format("{}: cuda has {}, cpu has {}; they differ first at index {}. ", name, found.size(),
                       expected.size(), place - found.begin());
}

/// Sets the members "right" and, if there is a difference, "difference" of a row of figures, and prints the difference.
void set_right(nlohmann::json& row, std::string_view name, const std::string& difference);

/// True if set_right() has marked no row in the figures as wrong, at any depth.
bool all_right(const nlohmann::json& figures);

}  // namespace crumple::benchmark
