#pragma once

// Rows of all ranks to rank 0.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "cli/ranks/rank_link.h"
#include "crumple/array.h"

namespace crumple::cli {

/// Collective. Rank 0 gets the rows of all ranks, one rank's behind the other's; the others get none.
template <class Row>
void gather(RankLink& link, std::span<const Row> mine, Array<Row>& all) {
    distribute::Traffic traffic(link.ranks());
    traffic.out[0] = static_cast<std::int64_t>(mine.size());
    link.transport().all_to_all(traffic.out, traffic.in);
    std::vector<std::int64_t> first(traffic.in.size() + 1, 0);
    std::partial_sum(traffic.in.begin(), traffic.in.end(), first.begin() + 1);
    link.agree([&] { all.resize_discard(static_cast<std::size_t>(first.back())); });
    link.rounds().exchange<Row>(
        traffic,
        [&](int, std::int64_t begin, std::span<Row> rows) {
            std::copy_n(mine.begin() + begin, rows.size(), rows.begin());
        },
        [&](int rank, std::int64_t begin, std::span<const Row> rows) {
            std::copy(rows.begin(), rows.end(), all.data() + first[static_cast<std::size_t>(rank)] + begin);
        });
}

}  // namespace crumple::cli
