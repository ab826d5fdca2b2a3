#include "cli/ranks/rank_features.h"

#include <algorithm>
#include <limits>

#include "cli/ranks/rank_gather.h"
#include "distributed/transport/exchange_lists.h"
#include "distributed/transport/merge_runs.h"
#include "io/lists/feature_tables.h"

namespace crumple::cli {
namespace {

constexpr auto edge_edge = static_cast<std::size_t>(FeatureKind::edge_edge);

std::span<const double> values_of(const ImpactList& list) { return list.toi.span(); }
std::span<const double> values_of(const ProximityList& list) { return list.squared_distance.span(); }
std::span<const std::uint8_t> flags_of(const ImpactList& list) { return list.start.span(); }
std::span<const std::uint8_t> flags_of(const ProximityList& list) { return list.touching.span(); }
Array<double>& values_of(ImpactList& list) { return list.toi; }
Array<double>& values_of(ProximityList& list) { return list.squared_distance; }
Array<std::uint8_t>& flags_of(ImpactList& list) { return list.start; }
Array<std::uint8_t>& flags_of(ProximityList& list) { return list.touching; }

/// Numbers of first features, in as many blocks as there are ranks.
class Ranges {
   public:
    Ranges(RankLink& link, std::span<const Pair> mine) {
        constexpr std::int64_t none = std::numeric_limits<std::int32_t>::max();
        first_ = link.least(mine.empty() ? none : mine.front().a);
        const std::int64_t last = link.largest(mine.empty() ? -1 : mine.back().a);
        blocks_ = {last < 0 ? 0 : last + 1 - first_, link.ranks()};
    }
    std::size_t rank_of(std::int32_t feature) const {
        return static_cast<std::size_t>(blocks_.reader_of(feature - first_));
    }

   private:
    std::int64_t first_;
    io::Blocks blocks_;
};

/// The vertices of an edge that a row names.
template <class Answer>
Edge ends_of(const Answer& found, std::int32_t edge) {
    const auto ids = found.edge_ids.span();
    return found.edges[std::lower_bound(ids.begin(), ids.end(), edge) - ids.begin()];
}

template <class Answer>
std::vector<TravellingRow> rows_of(const Answer& found, std::size_t kind) {
    const auto& list = found.lists[kind];
    const auto values = values_of(list);
    const auto flags = flags_of(list);
    std::vector<TravellingRow> rows;
    rows.reserve(list.pairs.size());
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
        const Pair pair = list.pairs[i];
        TravellingRow row{pair, {}, values[i], flags[i]};
        if (kind == edge_edge) row.ends = {ends_of(found, pair.a), ends_of(found, pair.b)};
        rows.push_back(row);
    }
    return rows;
}

io::FeatureRow as_written(const TravellingRow& row, std::size_t kind) {
    io::FeatureRow written;
    written.kind = io::kind_of(static_cast<FeatureKind>(kind));
    written.ids = {row.pair.a, row.pair.b, 0, 0};
    if (kind == edge_edge) written.ids = {row.ends[0].a, row.ends[0].b, row.ends[1].a, row.ends[1].b};
    written.value = row.value;
    written.flag = row.flag != 0;
    io::put_in_order(written);
    return written;
}

template <class Answer>
void collect_rows(RankLink& link, const OrderedRows& rows, const RankInput& input, Answer& all) {
    for (std::size_t kind = 0; kind < rows.size(); ++kind) {
        Array<TravellingRow> gathered;
        gather(link, std::span<const TravellingRow>(rows[kind]), gathered);
        link.agree([&] {
            auto& list = all.lists[kind];
            for (const TravellingRow& row : gathered) {
                list.pairs.push_back(row.pair);
                values_of(list).push_back(row.value);
                flags_of(list).push_back(row.flag);
            }
        });
        all.count += static_cast<std::int64_t>(gathered.size());
    }
    all.edges = collect_edges(link, input);
    link.agree([&] {
        all.first_edge.assign(1, 0);
        all.first_edge.push_back(static_cast<std::int64_t>(all.edges.size()));
    });
}

/// Each edge of the rank's triangles once, by the numbers of vertices over all ranks, in order.
std::vector<Edge> edges_of(const RankInput& input) {
    std::vector<Edge> edges = io::features_of(input.mesh).edges;
    for (Edge& edge : edges) {
        const auto [a, b] = std::minmax(input.vertex_ids[static_cast<std::size_t>(edge.a)],
                                        input.vertex_ids[static_cast<std::size_t>(edge.b)]);
        edge = {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)};
    }
    std::sort(edges.begin(), edges.end());
    return edges;
}

template <class Answer>
OrderedRows ordered(RankLink& link, const Answer& found) {
    OrderedRows rows;
    for (std::size_t kind = 0; kind < rows.size(); ++kind) {
        const Ranges ranges(link, found.lists[kind].pairs.span());
        std::vector<std::vector<TravellingRow>> for_rank;
        link.agree([&] {
            for_rank.resize(static_cast<std::size_t>(link.ranks()));
            for (const TravellingRow& row : rows_of(found, kind)) for_rank[ranges.rank_of(row.pair.a)].push_back(row);
        });
        const distribute::Traffic traffic =
            distribute::traffic_of(link.rounds(), [&](std::size_t rank) { return for_rank[rank].size(); });
        std::vector<TravellingRow>& coming = rows[kind];
        link.agree([&] { coming.resize(distribute::all(traffic.in)); });
        distribute::exchange_lists(
            link.rounds(), traffic, [&](std::size_t rank) -> auto& { return for_rank[rank]; }, coming);
        link.agree([&] { distribute::merge_runs(coming, [](const TravellingRow& row) { return row.pair; }); });
    }
    return rows;
}
}  // namespace

OrderedRows in_order(RankLink& link, const DistributedImpacts& found) { return ordered(link, found); }
OrderedRows in_order(RankLink& link, const DistributedProximities& found) { return ordered(link, found); }

RankText text_of(const RankLink& link, const OrderedRows& rows, io::ListKind of, io::PairFormat format) {
    RankText text;
    for (std::size_t kind = 0; kind < rows.size(); ++kind) {
        const bool heading = kind == 0 && link.is_first();
        text.push_back([&rows = rows[kind], &words = io::words_of(of), kind, format, heading](std::ostream& out) {
            const io::RowTable table = words.rows();
            io::RowWriter writer(out, table, format == io::PairFormat::csv);
            if (heading) writer.write_heading();
            for (const TravellingRow& row : rows) words.add(writer, as_written(row, kind), false);
        });
    }
    return text;
}

Array<Edge> collect_edges(RankLink& link, const RankInput& input) {
    std::vector<Edge> mine;
    link.agree([&] { mine = edges_of(input); });
    Array<Edge> all;
    gather(link, std::span<const Edge>(mine), all);
    link.agree([&] {
        std::sort(all.begin(), all.end());
        all.resize(static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin()));
    });
    return all;
}

void collect(RankLink& link, const OrderedRows& rows, const RankInput& input, Impacts& all) {
    collect_rows(link, rows, input, all);
}
void collect(RankLink& link, const OrderedRows& rows, const RankInput& input, Proximities& all) {
    collect_rows(link, rows, input, all);
}

}  // namespace crumple::cli
