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

/// Sorts rows that come in a few runs, each in order: those of one part from one rank.
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

std::size_t all(const std::vector<std::int64_t>& counts) {
    return static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
}

}  // namespace

void FoundRows::add(const AssembledPart& part, const Collisions& found) {
    const std::int32_t* const ids = part.part().mesh.ids.data();
    const bool contacts = !found.contacts.kinds.empty();
    std::vector<std::size_t> coming(for_rank_.size(), 0);
    for (const Pair pair : found.pairs) ++coming[static_cast<std::size_t>(part.rank_of(pair.a))];
    std::vector<Pair*> next;
    for (std::size_t r = 0; r < for_rank_.size(); ++r) {
        std::vector<Pair>& pairs = for_rank_[r].pairs;
        pairs.resize(pairs.size() + coming[r]);
        next.push_back(pairs.data() + pairs.size() - coming[r]);
    }
    for (const Pair pair : found.pairs)
        *next[static_cast<std::size_t>(part.rank_of(pair.a))]++ = {ids[pair.a], ids[pair.b]};
    for (std::size_t i = 0; contacts && i < found.pairs.size(); ++i) {
        Rows& rows = for_rank_[static_cast<std::size_t>(part.rank_of(found.pairs[i].a))];
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
    for_rank_.clear();
    agree(Phase::output, [&] { contacts ? order_contacts(coming, result) : order_pairs(coming, result); });
}

void FoundRows::order_pairs(Rows& coming, DistributedCollisions& result) {
    merge_runs(coming.pairs, [](Pair pair) { return pair; });
    result.pairs.resize_discard(coming.pairs.size());
    std::copy(coming.pairs.begin(), coming.pairs.end(), result.pairs.begin());
}

void FoundRows::order_contacts(Rows& coming, DistributedCollisions& result) {
    struct Place {
        Pair pair;
        std::uint32_t row;
        std::int64_t point;  ///< the first
    };
    const std::size_t n = coming.pairs.size();
    std::vector<Place> order(n);
    std::int64_t point = 0;
    for (std::size_t i = 0; i < n; ++i) {
        order[i] = {coming.pairs[i], static_cast<std::uint32_t>(i), point};
        point += coming.contacts[i].count;
    }
    merge_runs(order, [](const Place& place) { return place.pair; });
    Contacts& out = result.contacts;
    result.pairs.resize_discard(n);
    out.kinds.resize_discard(n);
    out.offsets.resize_discard(n + 1);
    out.points.resize_discard(coming.points.size());
    out.offsets[0] = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const auto [kind, count] = coming.contacts[order[i].row];
        result.pairs[i] = order[i].pair;
        out.kinds[i] = kind;
        std::copy_n(coming.points.begin() + static_cast<std::ptrdiff_t>(order[i].point), count,
                    out.points.data() + out.offsets[i]);
        out.offsets[i + 1] = out.offsets[i] + count;
    }
}

}  // namespace crumple::distribute
