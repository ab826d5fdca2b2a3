#pragma once

// Sorts rows that consist of a few sorted runs.

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace crumple::distribute {

/// Sorts rows by key. Stable. O(rows log runs).
template <class Row, class Key>
void merge_runs(std::vector<Row>& rows, Key key) {
    const auto before = [&](const Row& a, const Row& b) { return key(a) < key(b); };
    std::vector<std::size_t> first(1, 0);
    for (std::size_t i = 1; i < rows.size(); ++i)
        if (before(rows[i], rows[i - 1])) first.push_back(i);
    std::vector<Row> merged(first.size() > 1 ? rows.size() : 0);
    while (first.size() > 1) {
        std::vector<std::size_t> next;
        for (std::size_t r = 0; r < first.size(); r += 2) {
            const auto at = [&](std::size_t run) {
                return static_cast<std::ptrdiff_t>(run < first.size() ? first[run] : rows.size());
            };
            const auto begin = rows.begin();
            next.push_back(first[r]);
            std::merge(begin + at(r), begin + at(r + 1), begin + at(r + 1), begin + at(r + 2), merged.begin() + at(r),
                       before);
        }
        rows.swap(merged);
        first = std::move(next);
    }
}

}  // namespace crumple::distribute
