#include "comparison.h"

#include <cstdio>

namespace crumple::benchmark {

void set_right(nlohmann::json& row, std::string_view name, const std::string& difference) {
    row["right"] = difference.empty();
    if (difference.empty()) return;
    row["difference"] = difference;
    fmt::print(stderr, "error: {}: {}\n", name, difference);
}

bool all_right(const nlohmann::json& figures) {
    if (figures.is_object() && !figures.value("right", true)) return false;
    return !figures.is_structured() || std::ranges::all_of(figures, all_right);
}

}  // namespace crumple::benchmark
