#pragma once

// Comparison of a given list with the list that Crumple computes (the right one), for crumple verify.

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/color.h>
#include <fmt/format.h>

#include "cli/terminal.h"

namespace crumple::cli {

template <class Row>
struct RowComparison {
    std::vector<Row> missed, false_ones, repeated;

    bool right() const { return missed.empty() && false_ones.empty() && repeated.empty(); }
};

/// Compares a list with the right one. Both may be in any order. Rows are the same if key_of(row) is equal. Calls
/// meet(listed, exact) once for each row that is in both lists, with the row of each list.
template <class Row, class KeyOf, class Meet>
RowComparison<Row> compare_rows(std::vector<Row> list, std::vector<Row> right, KeyOf key_of, Meet meet) {
    const auto before = [&](const Row& a, const Row& b) { return key_of(a) < key_of(b); };
    std::stable_sort(list.begin(), list.end(), before);
    std::sort(right.begin(), right.end(), before);
    RowComparison<Row> result;
    auto exact = right.begin();
    for (auto row = list.begin(); row != list.end();) {
        for (; exact != right.end() && before(*exact, *row); ++exact) result.missed.push_back(*exact);
        const auto next = std::upper_bound(row, list.end(), *row, before);
        if (next - row > 1) result.repeated.push_back(*row);
        if (exact == right.end() || before(*row, *exact))
            result.false_ones.push_back(*row);
        else
            meet(*row, *exact++);
        row = next;
    }
    result.missed.insert(result.missed.end(), exact, right.end());
    return result;
}

/// Returns "right" or "wrong", in colour on a terminal.
inline std::string verdict(bool right) {
    const auto colour = fmt::fg(right ? fmt::terminal_color::green : fmt::terminal_color::red);
    return fmt::format(on_terminal(1, colour | fmt::emphasis::bold), right ? "right" : "wrong");
}

}  // namespace crumple::cli
