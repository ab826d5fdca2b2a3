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

/// Rows as an answer of their own, of which each edge is named once.
template <class Answer>
void fill(std::span<const TravellingRow> rows, std::size_t kind, Answer& block) {
    auto& list = block.lists[kind];
    Pair* pairs = list.pairs.resize_discard(rows.size());
    double* values = values_of(list).resize_discard(rows.size());
    std::uint8_t* flags = flags_of(list).resize_discard(rows.size());
    for (const TravellingRow& row : rows) *pairs++ = row.pair, *values++ = row.value, *flags++ = row.flag;
    if (kind != edge_edge) return;
    Edge* edges = block.edges.resize_discard(2 * rows.size());
    const auto count = static_cast<std::int32_t>(rows.size());
    for (std::int32_t i = 0; i < count; ++i) {
        list.pairs[i] = {2 * i, 2 * i + 1};
        for (const Edge& edge : rows[static_cast<std::size_t>(i)].ends) *edges++ = edge;
    }
    block.first_edge.assign(1, 0);
    block.first_edge.push_back(2 * std::int64_t{count});
}

// In blocks: rows are text as they are made.
template <class Answer>
void write_rows(std::ostream& out, const std::vector<TravellingRow>& rows, std::size_t kind, io::PairFormat format) {
    constexpr std::size_t most = std::size_t{1} << 14;
    Answer block;
    for (std::size_t begin = 0; begin < rows.size(); begin += most) {
        fill(std::span(rows).subspan(begin, std::min(most, rows.size() - begin)), kind, block);
        io::write_list_rows(out, io::table_of(block), format);
    }
}

/// A section of the text.
template <class Answer>
std::function<void(std::ostream&)> section(const OrderedRows& rows, std::size_t kind, io::PairFormat format,
                                           const io::FeatureWords* heading) {
    return [&rows = rows[kind], kind, format, heading](std::ostream& out) {
        if (heading) io::write_list_heading(out, heading->rows(), format);
        write_rows<Answer>(out, rows, kind, format);
    };
}

template <class Answer>
void collect_rows(RankLink& link, const OrderedRows& rows, const RankInput& input, Answer& all) {
    for (std::size_t kind = 0; kind < rows.size(); ++kind) {
        Answer mine;
        link.agree([&] { fill(std::span(rows[kind]), kind, mine); });
        auto &from = mine.lists[kind], &to = all.lists[kind];
        for (std::size_t i = 0; i < rows[kind].size(); ++i) from.pairs[i] = rows[kind][i].pair;
        gather(link, std::span<const Pair>(from.pairs.span()), to.pairs);
        gather(link, std::span<const double>(values_of(from).span()), values_of(to));
        gather(link, std::span<const std::uint8_t>(flags_of(from).span()), flags_of(to));
        all.count += static_cast<std::int64_t>(to.pairs.size());
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
    const bool impacts = of == io::ListKind::impacts;
    RankText text;
    for (std::size_t kind = 0; kind < rows.size(); ++kind) {
        const io::FeatureWords* const heading = kind > 0 || !link.is_first() ? nullptr
                                                : impacts                    ? &io::impact_words
                                                                             : &io::near_words;
        text.push_back(impacts ? section<Impacts>(rows, kind, format, heading)
                               : section<Proximities>(rows, kind, format, heading));
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
