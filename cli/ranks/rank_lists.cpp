#include "cli/ranks/rank_lists.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "cli/search.h"
#include "crumple/io_features.h"
#include "distributed/transport/merge_runs.h"
#include "io/lists/feature_tables.h"
#include "io/lists/pairs.h"

namespace crumple::cli {
namespace {

template <class Value>
void assign(Array<Value>& array, const std::vector<Value>& values) {
    std::copy(values.begin(), values.end(), array.resize_discard(values.size()));
}

/// Row of one kind of feature pairs, in the form in which it is sent between ranks.
struct SentRow {
    Pair pair;           ///< the two features, by their ids over all ranks
    io::FeatureRow row;  ///< the row as it is written, in which vertices identify edges
};
using RowsByKind = std::array<std::vector<SentRow>, feature_kinds>;

/// Returns the rows that this rank has found. `value`, `flag`: pointers to the members of a list with its values and
/// flags.
template <auto value, auto flag, class Found>
std::vector<SentRow> rows_of(const Found& found, std::size_t kind) {
    const auto ends_of = [ids = found.edge_ids.span(), &found](std::int32_t edge) {
        return found.edges[std::lower_bound(ids.begin(), ids.end(), edge) - ids.begin()];
    };
    const auto& list = found.lists[kind];
    const CandidateKind of = io::kind_of(static_cast<FeatureKind>(kind));
    std::vector<SentRow> rows;
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
        const Pair pair = list.pairs[i];
        io::FeatureRow row{{of, {}, {pair.a, pair.b}}, (list.*value)[i], (list.*flag)[i] != 0};
        if (of == CandidateKind::edge_edge) {
            const Edge first = ends_of(pair.a), second = ends_of(pair.b);
            row.ids = {first.a, first.b, second.a, second.b};
        }
        io::put_in_order(row);
        rows.push_back({pair, row});
    }
    return rows;
}

/// Collective. Sorts the rows of all ranks together. A rank has found the rows whose first feature its triangles own,
/// but lists are in the order of feature ids. So rows are redistributed: each rank gets the rows whose first feature is
/// in its range of ids.
template <auto value, auto flag, class Found>
RowsByKind rows_in_order(RankLink& link, const Found& found) {
    RowsByKind by_kind;
    for (std::size_t kind = 0; kind < by_kind.size(); ++kind) {
        std::vector<SentRow>& rows = by_kind[kind];
        link.run_checked([&] { rows = rows_of<value, flag>(found, kind); });
        const std::int64_t first =
            link.least(rows.empty() ? std::numeric_limits<std::int32_t>::max() : rows.front().pair.a);
        const io::Blocks features{link.largest(rows.empty() ? -1 : rows.back().pair.a) + 1 - first, link.ranks()};
        rows = link.redistribute(rows, [&](std::size_t i) { return features.reader_of(rows[i].pair.a - first); });
        link.run_checked([&] { distribute::merge_runs(rows, [](const SentRow& row) { return row.pair; }); });
    }
    return by_kind;
}

/// Collective. Returns on rank 0 all edges of the triangles of all ranks, each once, in the order in which a single
/// process numbers edges.
std::vector<Edge> edges_of_all(RankLink& link, const RankInput& input) {
    const auto over_all_ranks = [&](std::int32_t vertex) {
        return static_cast<std::int32_t>(input.vertex_ids[static_cast<std::size_t>(vertex)]);
    };
    std::vector<Edge> edges;
    link.run_checked([&] {
        edges = io::features_of(input.mesh).edges;
        for (Edge& edge : edges) edge = {over_all_ranks(edge.a), over_all_ranks(edge.b)};
    });
    edges = link.gather(edges);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

template <class Result, auto value, auto flag, class Found>
RankList<Result> rank_list_of_features(RankLink& link, const RankInput& input, const Found& found,
                                       const io::FeatureWords& words) {
    const auto rows = std::make_shared<const RowsByKind>(rows_in_order<value, flag>(link, found));
    RankList<Result> list{words.rows(), {}, {}};
    for (std::size_t kind = 0; kind < rows->size(); ++kind)
        list.sections.push_back([rows, kind, words](io::RowWriter& writer) {
            for (const SentRow& row : (*rows)[kind]) words.add(writer, row.row, false);
        });
    list.collect = [rows, &link, &input] {
        Result all;
        for (std::size_t kind = 0; kind < rows->size(); ++kind) {
            const std::vector<SentRow> of_all = link.gather((*rows)[kind]);
            link.run_checked([&] {
                auto& to = all.lists[kind];
                for (const SentRow& row : of_all) {
                    to.pairs.push_back(row.pair);
                    (to.*value).push_back(row.row.value);
                    (to.*flag).push_back(row.row.flag ? 1 : 0);
                }
            });
            all.count += static_cast<std::int64_t>(of_all.size());
        }
        const std::vector<Edge> edges = edges_of_all(link, input);
        link.run_checked([&] {
            assign(all.edges, edges);
            assign(all.first_edge, {0, static_cast<std::int64_t>(edges.size())});
        });
        return all;
    };
    return list;
}

/// Collective. Returns the contacts of all ranks on rank 0.
Contacts collect(RankLink& link, const Contacts& mine) {
    std::vector<std::int64_t> counts;  // number of points of each pair
    link.run_checked([&] {
        for (std::size_t i = 0; i < mine.kinds.size(); ++i) counts.push_back(mine.offsets[i + 1] - mine.offsets[i]);
    });
    counts = link.gather(counts);
    const auto kinds = link.gather(mine.kinds);
    const auto points = link.gather(mine.points);
    Contacts all;
    link.run_checked([&] {
        assign(all.kinds, kinds);
        assign(all.points, points);
        all.offsets.push_back(0);
        for (const std::int64_t count : counts) all.offsets.push_back(all.offsets.back() + count);
    });
    return all;
}

}  // namespace

RankList<Intersections> rank_list_of(RankLink& link, const RankInput& input, const IntersectionQuery& query,
                                     const DistributedIntersections& found) {
    const auto add_rows = [&found](io::RowWriter& writer) {
        io::add_pairs(writer, found.pairs.span(), found.contacts);
    };
    const auto collect_pairs = [&link, &found, contacts = query.contacts(), triangles = input.triangles.rows] {
        Intersections all;
        const std::vector<Pair> pairs = link.gather(found.pairs);
        if (contacts) all.contacts = collect(link, found.contacts);
        link.run_checked([&] {
            assign(all.pairs, pairs);
            if (link.is_first()) index_by_triangle(all, triangles, 0);
        });
        return all;
    };
    return {io::pair_rows(query.contacts()), {add_rows}, collect_pairs};
}

RankList<Impacts> rank_list_of(RankLink& link, const RankInput& input, const ImpactQuery&,
                               const DistributedImpacts& found) {
    return rank_list_of_features<Impacts, &ImpactList::toi, &ImpactList::start>(link, input, found, io::impact_words);
}

RankList<Proximities> rank_list_of(RankLink& link, const RankInput& input, const ProximityQuery&,
                                   const DistributedProximities& found) {
    return rank_list_of_features<Proximities, &ProximityList::squared_distance, &ProximityList::touching>(
        link, input, found, io::near_words);
}

std::int64_t count_hits(RankLink& link, const DistributedIntersections& found, io::Blocks triangles) {
    const std::int64_t begin = triangles.begin(link.rank());
    std::vector<std::uint8_t> hit;
    std::vector<std::int32_t> seconds;
    link.run_checked([&] {
        hit.assign(static_cast<std::size_t>(triangles.size(link.rank())), 0);
        for (const Pair& pair : found.pairs) {
            hit[static_cast<std::size_t>(pair.a - begin)] = 1;
            seconds.push_back(pair.b);
        }
    });
    seconds = link.redistribute(seconds, [&](std::size_t i) { return triangles.reader_of(seconds[i]); });
    for (const std::int32_t triangle : seconds) hit[static_cast<std::size_t>(triangle - begin)] = 1;
    return link.sum(std::count(hit.begin(), hit.end(), std::uint8_t{1}));
}

}  // namespace crumple::cli
