#pragma once

// Exchanges lists between ranks: each rank sends one list to each rank, itself included.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

/// Returns the numbers of rows to send and to receive if this rank has a list of size(r) rows for each rank r.
/// Collective.
template <class Size>
Traffic traffic_of(MessageBatches& batches, Size size) {
    Traffic traffic(batches.transport().size());
    for (std::size_t r = 0; r < traffic.out.size(); ++r) traffic.out[r] = static_cast<std::int64_t>(size(r));
    batches.transport().all_to_all(traffic.out, traffic.in);
    return traffic;
}

inline std::size_t all(const std::vector<std::int64_t>& counts) {
    return static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
}

/// Returns the offset of the rows of each rank, then the end.
inline std::vector<std::int64_t> first_of_each(const std::vector<std::int64_t>& counts) {
    std::vector<std::int64_t> first(1, 0);
    for (const std::int64_t count : counts) first.push_back(first.back() + count);
    return first;
}

/// Sends the vector list(rank) to each rank. `coming` receives the rows of all ranks, those of rank 0 first; it must
/// already have the right size. Collective.
template <class Row, class List>
void exchange_lists(MessageBatches& batches, const Traffic& traffic, List list, std::vector<Row>& coming) {
    const std::vector<std::int64_t> first = first_of_each(traffic.in);
    batches.exchange<Row>(
        traffic,
        [&](int rank, std::int64_t begin, std::span<Row> rows) {
            const std::vector<Row>& from = list(static_cast<std::size_t>(rank));
            std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(begin), rows.size(), rows.begin());
        },
        [&](int rank, std::int64_t begin, std::span<const Row> rows) {
            std::copy(rows.begin(), rows.end(),
                      coming.begin() + static_cast<std::ptrdiff_t>(first[static_cast<std::size_t>(rank)] + begin));
        });
}

}  // namespace crumple::distribute
