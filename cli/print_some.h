#pragma once

#include <algorithm>
#include <ostream>
#include <vector>

#include <fmt/format.h>

namespace crumple::cli {

/// Prints a line with `what` and text(row) for each of the first ten rows, then the number of further rows.
template <class Row, class Text>
void print_some(std::ostream& out, const char* what, const std::vector<Row>& rows, Text text) {
    constexpr std::size_t most = 10;
    for (std::size_t i = 0; i < std::min(rows.size(), most); ++i) out << what << ' ' << text(rows[i]) << '\n';
    if (rows.size() > most) out << fmt::format("and {} more {}\n", rows.size() - most, what);
}

}  // namespace crumple::cli
