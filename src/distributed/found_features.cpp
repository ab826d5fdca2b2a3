#include "distributed/found_features.h"

#include <algorithm>

#include "distributed/transport/exchange_lists.h"
#include "distributed/transport/merge_runs.h"

namespace crumple::distribute {

template <class Result, class Fill>
void FoundFeatures::add_rows(const FeatureAssembly& part, const Result& found, Fill fill) {
    for (std::size_t k = 0; k < kinds; ++k) {
        const bool edges = static_cast<FeatureKind>(k) == FeatureKind::edge_edge;
        const auto& list = found.lists[k];
        for (std::size_t i = 0; i < list.pairs.size(); ++i) {
            const Pair pair = list.pairs[i];
            Row row{pair, {}, 0, {}, 0, 0};
            if (edges) row.ends = {part.ends_of_edge(pair.a), part.ends_of_edge(pair.b)};
            fill(list, i, row);
            const int rank = edges ? part.rank_of_edge(pair.a) : part.rank_of_vertex(pair.a);
            for_rank_[static_cast<std::size_t>(rank)][k].push_back(row);
        }
    }
}

void FoundFeatures::add(const FeatureAssembly& part, const Impacts& found) {
    add_rows(part, found, [](const ImpactList& list, std::size_t i, Row& row) {
        row.value = list.toi[i];
        row.flag = list.start[i];
    });
}

void FoundFeatures::add(const FeatureAssembly& part, const Proximities& found) {
    add_rows(part, found, [](const ProximityList& list, std::size_t i, Row& row) {
        row.value = list.squared_distance[i];
        row.flag = list.touching[i];
        if (list.type.empty()) return;
        row.type = list.type[i];
        row.at = list.at[i];
    });
}

template <class Result, class Write>
void FoundFeatures::exchange_rows(MessageBatches& batches, CollectiveCheck& agree, Result& result, Write write) {
    Rows coming;
    std::array<Traffic, kinds> traffic{Traffic(0), Traffic(0)};
    for (std::size_t k = 0; k < kinds; ++k)
        traffic[k] = traffic_of(batches, [&](std::size_t r) { return for_rank_[r][k].size(); });
    agree(Phase::rows, [&] {
        for (std::size_t k = 0; k < kinds; ++k) coming[k].resize(all(traffic[k].in));
    });
    for (std::size_t k = 0; k < kinds; ++k)
        exchange_lists(
            batches, traffic[k], [&](std::size_t r) -> auto& { return for_rank_[r][k]; }, coming[k]);
    for_rank_.clear();
    agree(Phase::output, [&] {
        std::vector<std::pair<std::int32_t, Edge>> edges;
        for (std::size_t k = 0; k < kinds; ++k) {
            std::vector<Row>& rows = coming[k];
            merge_runs(rows, [](const Row& row) { return row.pair; });
            auto& list = result.lists[k];
            list.pairs.resize(rows.size());
            for (std::size_t i = 0; i < rows.size(); ++i) list.pairs[i] = rows[i].pair;
            write(rows, list);
            if (static_cast<FeatureKind>(k) != FeatureKind::edge_edge) continue;
            for (const Row& row : rows)
                edges.insert(edges.end(), {{row.pair.a, row.ends[0]}, {row.pair.b, row.ends[1]}});
        }
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        result.edge_ids.resize(edges.size());
        result.edges.resize(edges.size());
        for (std::size_t i = 0; i < edges.size(); ++i)
            result.edge_ids[i] = edges[i].first, result.edges[i] = edges[i].second;
    });
}

void FoundFeatures::exchange(MessageBatches& batches, CollectiveCheck& agree, DistributedImpacts& result) {
    exchange_rows(batches, agree, result, [](const std::vector<Row>& rows, ImpactList& list) {
        list.toi.resize(rows.size());
        list.start.resize(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) list.toi[i] = rows[i].value, list.start[i] = rows[i].flag;
    });
}

void FoundFeatures::exchange(MessageBatches& batches, CollectiveCheck& agree, DistributedProximities& result) {
    exchange_rows(batches, agree, result, [&](const std::vector<Row>& rows, ProximityList& list) {
        list.squared_distance.resize(rows.size());
        list.touching.resize(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i)
            list.squared_distance[i] = rows[i].value, list.touching[i] = rows[i].flag;
        if (!result.closest) return;
        list.type.resize(rows.size());
        list.at.resize(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) list.type[i] = rows[i].type, list.at[i] = rows[i].at;
    });
}

}  // namespace crumple::distribute
