#include "distributed/found_rows.h"

#include <algorithm>

#include "distributed/transport/exchange_lists.h"
#include "distributed/transport/merge_runs.h"

namespace crumple::distribute {
void FoundRows::add(const AssembledPart& part, const Intersections& found) {
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

void FoundRows::exchange(MessageBatches& batches, CollectiveCheck& agree, bool contacts,
                         DistributedIntersections& result) {
    const Traffic traffic = traffic_of(batches, [&](std::size_t r) { return for_rank_[r].pairs.size(); });
    const Traffic of_points = contacts ? traffic_of(batches, [&](std::size_t r) { return for_rank_[r].points.size(); })
                                       : Traffic(batches.transport().size());
    Rows coming;
    agree(Phase::rows, [&] {
        coming.pairs.resize(all(traffic.in));
        if (contacts) coming.contacts.resize(coming.pairs.size());
        coming.points.resize(all(of_points.in));
    });
    exchange_lists(
        batches, traffic, [&](std::size_t r) -> auto& { return for_rank_[r].pairs; }, coming.pairs);
    if (contacts) {
        exchange_lists(
            batches, traffic, [&](std::size_t r) -> auto& { return for_rank_[r].contacts; }, coming.contacts);
        exchange_lists(
            batches, of_points, [&](std::size_t r) -> auto& { return for_rank_[r].points; }, coming.points);
    }
    for_rank_.clear();
    agree(Phase::output, [&] { contacts ? order_contacts(coming, result) : order_pairs(coming, result); });
}

void FoundRows::order_pairs(Rows& coming, DistributedIntersections& result) {
    merge_runs(coming.pairs, [](Pair pair) { return pair; });
    result.pairs.resize_discard(coming.pairs.size());
    std::copy(coming.pairs.begin(), coming.pairs.end(), result.pairs.begin());
}

void FoundRows::order_contacts(Rows& coming, DistributedIntersections& result) {
    struct Place {
        Pair pair;
        std::uint32_t row;
        std::int64_t point;  ///< index of the first point
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
