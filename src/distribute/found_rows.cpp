#include "distribute/found_rows.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace crumple::distribute {
namespace {

/// A list for each rank, from each rank: all that come lie in one, those of rank 0 first.
template <class Row, class List>
void exchange_lists(Rounds& rounds, const Traffic& traffic, List list, std::vector<Row>& coming) {
    std::vector<std::int64_t> first(1, 0);
    for (const std::int64_t rows : traffic.in) first.push_back(first.back() + rows);
    rounds.exchange<Row>(
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

template <class List>
Traffic traffic_of(Rounds& rounds, List size) {
    Traffic traffic(rounds.transport().size());
    for (std::size_t r = 0; r < traffic.out.size(); ++r) traffic.out[r] = static_cast<std::int64_t>(size(r));
    rounds.transport().all_to_all(traffic.out, traffic.in);
    return traffic;
}

std::size_t all(const std::vector<std::int64_t>& counts) {
    return static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
}

}  // namespace

void FoundRows::add(const AssembledPart& part, const Collisions& found) {
    const std::vector<std::int32_t>& ids = part.part().mesh.ids;
    const bool contacts = !found.contacts.kinds.empty();
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
        const Pair pair = found.pairs[i];
        Rows& rows = for_rank_[static_cast<std::size_t>(part.rank_of(pair.a))];
        rows.pairs.push_back({ids[static_cast<std::size_t>(pair.a)], ids[static_cast<std::size_t>(pair.b)]});
        if (!contacts) continue;
        const std::int64_t begin = found.contacts.offsets[i], end = found.contacts.offsets[i + 1];
        rows.contacts.push_back({found.contacts.kinds[i], static_cast<std::uint8_t>(end - begin)});
        rows.points.insert(rows.points.end(), found.contacts.points.data() + begin, found.contacts.points.data() + end);
    }
}

void FoundRows::exchange(Rounds& rounds, Agreement& agree, bool contacts, DistributedCollisions& result) {
    const Traffic traffic = traffic_of(rounds, [&](std::size_t r) { return for_rank_[r].pairs.size(); });
    const Traffic of_points = contacts ? traffic_of(rounds, [&](std::size_t r) { return for_rank_[r].points.size(); })
                                       : Traffic(rounds.transport().size());
    Rows coming;
    agree(Phase::rows, [&] {
        coming.pairs.resize(all(traffic.in));
        if (contacts) coming.contacts.resize(coming.pairs.size());
        coming.points.resize(all(of_points.in));
    });
    exchange_lists(
        rounds, traffic, [&](std::size_t r) -> auto& { return for_rank_[r].pairs; }, coming.pairs);
    if (contacts) {
        exchange_lists(
            rounds, traffic, [&](std::size_t r) -> auto& { return for_rank_[r].contacts; }, coming.contacts);
        exchange_lists(
            rounds, of_points, [&](std::size_t r) -> auto& { return for_rank_[r].points; }, coming.points);
    }
    agree(Phase::output, [&] {
        const std::size_t n = coming.pairs.size();
        result.pairs.resize_discard(n);
        if (!contacts) {
            std::copy(coming.pairs.begin(), coming.pairs.end(), result.pairs.begin());
            if (!std::is_sorted(result.pairs.begin(), result.pairs.end()))
                std::sort(result.pairs.begin(), result.pairs.end());
            return;
        }
        std::vector<std::int64_t> first(n + 1, 0);
        for (std::size_t i = 0; i < n; ++i) first[i + 1] = first[i] + coming.contacts[i].count;
        std::vector<std::size_t> order(n);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(),
                  [&](std::size_t i, std::size_t j) { return coming.pairs[i] < coming.pairs[j]; });
        Contacts& out = result.contacts;
        out.kinds.resize_discard(n);
        out.offsets.resize_discard(n + 1);
        out.points.resize_discard(coming.points.size());
        out.offsets[0] = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t from = order[i];
            result.pairs[i] = coming.pairs[from];
            out.kinds[i] = coming.contacts[from].kind;
            std::copy(coming.points.begin() + static_cast<std::ptrdiff_t>(first[from]),
                      coming.points.begin() + static_cast<std::ptrdiff_t>(first[from + 1]),
                      out.points.data() + out.offsets[i]);
            out.offsets[i + 1] = out.offsets[i] + coming.contacts[from].count;
        }
    });
}

}  // namespace crumple::distribute
