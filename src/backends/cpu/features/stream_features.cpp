#include "backends/cpu/features/stream_features.h"

#include <array>
#include <atomic>
#include <vector>

#include "base/stopwatch.h"

namespace crumple::cpu {
namespace {

// Rows that a worker gathers before it hands them over.
constexpr std::size_t worth_a_lock = 2048;

// How many rows a search has found so far, and whether they are too many.
struct Found {
    std::int64_t most;
    std::atomic<std::int64_t> rows{0};
    std::atomic<bool> enough{false};

    void begin() {
        rows = 0;
        enough = false;
    }
    void add(std::size_t more) {
        const auto n = static_cast<std::int64_t>(more);
        if (rows.fetch_add(n, std::memory_order_relaxed) + n > most) enough.store(true, std::memory_order_relaxed);
    }
};

// Calls answer(range) for one range of pairs of features after another, in order: it returns how many rows there are,
// or more than `most` if they were too many.
template <class Answer>
void for_each_feature_range(const SceneFeatures& features, FeatureTypes types, std::int64_t most, Answer answer) {
    const std::int64_t seconds = count_of(features, types.second);
    const bool alike = types.first == types.second;  // then the first is the lesser one
    const auto seconds_of = [&](std::int64_t first) { return IdRange{alike ? first + 1 : 0, seconds}; };
    const auto of_firsts = [&](IdRange firsts) { return answer({types, firsts, seconds_of(firsts.begin)}); };
    const auto of_one = [&](std::int64_t first) {
        const auto of_seconds = [&](IdRange ids) { return answer({types, {first, first + 1}, ids}); };
        for_each_range(seconds_of(first), most, of_seconds, [](std::int64_t) {});  // two features are one row
    };
    for_each_range({0, count_of(features, types.first)}, most, of_firsts, of_one);
}

// search(range, kind) returns how many rows it has found, of all kinds if range is null; hand_over(kind, firsts) hands
// those of a kind over.
template <class Kind, class Search, class HandOver>
void stream_in_order(const SceneFeatures& features, const std::vector<Kind>& kinds, std::int64_t most, Search search,
                     HandOver hand_over) {
    if (kinds.empty()) return;
    if (search(nullptr, kinds[0]) <= most) {
        for (const Kind kind : kinds) hand_over(kind, IdRange{0, count_of(features, types_of(kind).first)});
        return;
    }
    for (const Kind kind : kinds)
        for_each_feature_range(features, types_of(kind), most, [&](const FeatureRange& range) {
            const std::int64_t rows = search(&range, kind);
            if (rows > 0 && rows <= most) hand_over(kind, range.first);
            return rows;
        });
}

// Kinds of which there may be pairs, in the order of the answer.
std::vector<FeatureKind> kinds_of(const FeatureRequest& query) {
    using enum FeatureKind;
    if (query.features.carriers() == 0) return {vertex_face, edge_edge};
    return {vertex_face, edge_edge, vertex_edge, vertex_vertex};
}
std::vector<CandidateKind> kinds_of(const CandidateRequest& query) {
    std::vector<CandidateKind> kinds;
    for (std::size_t k = 0; k < candidate_kinds; ++k)
        if (query.wanted[k]) kinds.push_back(static_cast<CandidateKind>(k));
    return kinds;
}

template <class Kind, class Lists, class Sink>
void hand_over_all(Lists& lists, Sink sink) {
    for (std::size_t k = 0; k < lists.size(); ++k) {
        if (lists[k].empty()) continue;
        sink(static_cast<Kind>(k), lists[k].span());
        lists[k].clear();
    }
}

// Has the leaves hand over what they find, by `sink`, while `search` runs.
template <class Kind, class Lists, class HitSink, class Share, class Leaves, class Sink, class Search>
void stream_as_found(const Call& call, Leaves& leaves, Sink sink, Search search) {
    const auto told = [&](Lists& lists, std::size_t) {
        std::size_t rows = 0;
        for (const auto& list : lists) rows += list.size();
        if (rows >= worth_a_lock) hand_over_all<Kind>(lists, sink);
    };
    const HitSink taken = told;
    Share share;
    share.sink = &taken;
    leaves.ask_for(share);
    measure(call);
    search();
    for (int w = 0; w < call.workers.workers(); ++w)
        hand_over_all<Kind>(leaves.hits(static_cast<std::size_t>(w)), sink);
}

}  // namespace

void stream_in_order(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, std::int64_t most,
                     FeatureSink sink) {
    with_leaves(call, query, buffers, [&](auto& leaves) {
        Found found{most};
        const auto told = [&](FeatureHits&, std::size_t more) { found.add(more); };
        const HitSink counted = told;
        const auto search_share = [&](const FeatureRange* range, FeatureKind kind) {
            found.begin();
            leaves.ask_for({range, kind, &counted, &found.enough});
            search(call);
            return found.rows.load();
        };
        const auto hand_over = [&](FeatureKind kind, IdRange firsts) {
            Stopwatch watch;
            sort_hits(leaves.found(kind), firsts, call.workers, buffers);
            call.statistics[Stage::output] += watch.lap();
            if (!buffers.placed.empty()) sink(kind, buffers.placed.span());
        };
        measure(call);
        stream_in_order(query.features, kinds_of(query), most, search_share, hand_over);
    });
}

void stream_in_order(const Call& call, const CandidateRequest& query, CandidateBuffers& buffers, std::int64_t most,
                     CandidateSink sink) {
    CandidateLeaves& leaves = buffers.leaves;
    CandidateRequest asked = query;
    Found found{most};
    const auto told = [&](CandidateHits&, std::size_t more) { found.add(more); };
    const CandidateHitSink counted = told;
    const auto search_share = [&](const FeatureRange* range, CandidateKind kind) {
        found.begin();
        if (range) asked.wanted = {};
        asked.wanted[static_cast<std::size_t>(kind)] = true;
        leaves.ask(asked);
        leaves.ask_for({range, kind, &counted, &found.enough});
        search_candidates(call, asked, leaves);
        return found.rows.load();
    };
    const auto hand_over = [&](CandidateKind kind, IdRange) {
        Stopwatch watch;
        sort_candidates(call, query, kind, buffers, buffers.sorted);
        call.statistics[Stage::output] += watch.lap();
        if (!buffers.sorted.empty()) sink(kind, buffers.sorted.span());
    };
    measure(call);
    stream_in_order(query.features, kinds_of(query), most, search_share, hand_over);
}

void stream_as_found(const Call& call, const FeatureRequest& query, FeatureBuffers& buffers, FeatureSink sink) {
    with_leaves(call, query, buffers, [&](auto& leaves) {
        stream_as_found<FeatureKind, FeatureHits, HitSink, FeatureShare>(call, leaves, sink, [&] { search(call); });
    });
}

void stream_as_found(const Call& call, const CandidateRequest& query, CandidateBuffers& buffers, CandidateSink sink) {
    buffers.leaves.ask(query);
    stream_as_found<CandidateKind, CandidateHits, CandidateHitSink, CandidateShare>(
        call, buffers.leaves, sink, [&] { search_candidates(call, query, buffers.leaves); });
}

}  // namespace crumple::cpu
