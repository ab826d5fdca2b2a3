#include "questions/features/cpu/leaves.h"

#include <algorithm>
#include <limits>

#include "base/float_environment.h"
#include "base/stopwatch.h"
#include "engine/cpu/order.h"
#include "engine/output.h"
#include "questions/features/separation.h"
#include "questions/features/tests_of_pair.h"

namespace crumple::cpu {
namespace {

// What stands at rows without a member: it owns nothing, so that no pair with it is a test.
template <int moments>
FeatureRecord<moments> dummy_record() {
    FeatureRecord<moments> record{};
    for (int k = 0; k < 3; ++k) record.vertex[k] = record.edge[k] = -1;
    record.triangle = -1;
    return record;
}

}  // namespace

template <int moments>
FeatureLeaves<moments>::FeatureLeaves(MemoryMeter* meter, int workers, const FeatureTables& kernels)
    : kernels_(kernels.of<moments>()) {
    for (int w = 0; w < workers; ++w) {
        worker_.push_back(std::make_unique<Worker>(meter));
        for (std::size_t kind = 0; kind < feature_kinds; ++kind) found_[kind].push_back(&worker_.back()->hits[kind]);
    }
}

template <int moments>
void FeatureLeaves<moments>::ask(const FeatureQuery& query, float distance) {
    query_ = &query;
    distance_ = distance;
}

template <int moments>
void FeatureLeaves<moments>::begin(const Call& call) {
    call_ = &call;
    any_ = false;
    for (const auto& worker : worker_) {
        for (auto& list : worker->hits) list.clear();
        worker->statistics = {};
    }
}

template <int moments>
bool FeatureLeaves<moments>::stop() const {
    call_->cancellation.check();
    return query_->extent == Extent::any && any_.load(std::memory_order_relaxed);
}

template <int moments>
void FeatureLeaves<moments>::build(const BuildInput& input, LeafMembers& members, std::size_t w) {
    Worker& worker = *worker_[w];
    worker.built.resize_discard(static_cast<std::size_t>(input.members + padding));
    kernels_.build(input, query_->features, worker.built.data(), members.boxes, members.bounds);
    worker.reach = members.bounds.reach;
}

template <int moments>
void FeatureLeaves<moments>::place(const SortedLeaf& leaf, std::size_t w) {
    Worker& worker = *worker_[w];
    worker.sorted.resize_discard(static_cast<std::size_t>(leaf.rows + padding));
    for_each_dummy(leaf, [&](std::int64_t row) { worker.sorted[row] = dummy_record<moments>(); });
    kernels_.scatter(worker.built.data(), leaf.members, leaf.position.data(), worker.sorted.data());
}

template <int moments>
void FeatureLeaves<moments>::sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first,
                                   std::int64_t last, std::size_t builder, std::size_t w) {
    Worker& worker = *worker_[w];
    Candidates& candidates = worker.candidates;
    Statistics& statistics = worker.statistics;
    Stopwatch watch;
    const auto asked_to_stop = [&] {
        watch.lap();
        return stop();
    };
    sweep_chunks(call_->kernels, leaf, first, last, candidates, asked_to_stop, [&] {
        statistics[Stage::sweep] += watch.lap();
        if (candidates.pairs == 0) return;
        statistics.box_overlaps += candidates.pairs;
        narrow(leaf, ownership, *worker_[builder], worker);
        statistics[Stage::narrow] += watch.lap();
    });
}

template <int moments>
void FeatureLeaves<moments>::narrow(const SortedLeaf& leaf, const Ownership& ownership, const Worker& builder,
                                    Worker& worker) {
    list_tests(leaf, ownership, builder, worker);
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const auto kind = static_cast<FeatureKind>(k);
        Array<FeatureTest>& tests = worker.tests[k];
        worker.statistics.edge_tests += static_cast<std::int64_t>(tests.size());
        const std::int64_t ends = call_->scene.moving ? call_->scene.vertex_count() : 0;
        if (query_->share == 0)
            tests.resize(kernels_.filter[k](call_->points(), ends, distance_, tests.data(), tests.size()));
        worker.statistics.double_tests += static_cast<std::int64_t>(tests.size());
        decide_tests(kind, worker);
    }
}

// The tests of all candidates that no direction separates.
template <int moments>
void FeatureLeaves<moments>::list_tests(const SortedLeaf& leaf, const Ownership& ownership, const Worker& builder,
                                        Worker& worker) const {
    const Candidates& candidates = worker.candidates;
    const Scene& scene = call_->scene;
    const GroupRule& rule = call_->rule;
    worker.left.resize_discard(static_cast<std::size_t>(candidates.count + padding));
    std::size_t left = 0;
    {
        const FlushToZero mode;
        // A share of the distance at the start is the business of the decision.
        const float gap = query_->share == 0 ? needed_gap(distance_, builder.reach) : std::numeric_limits<float>::max();
        left = kernels_.separate(builder.sorted.data(), candidates, gap, worker.left.data());
    }
    const auto ours = [&](std::int64_t row, std::int64_t column) {
        const std::int32_t a = leaf.link[row].triangle, b = leaf.link[column].triangle;
        if (!ownership.complete() && !ownership.owns(a, leaf.member[row], b, leaf.member[column])) return false;
        return rule.trivial() || rule(scene.group(a), scene.group(b));
    };
    const bool check = !ownership.complete() || !rule.trivial();
    const SceneFeatures& features = query_->features;
    const auto name = [&](std::int32_t vertex) { return features.name(vertex); };
    auto& [vertex_faces, edge_edges] = worker.tests;
    vertex_faces.clear();
    edge_edges.clear();
    for (std::size_t i = 0; i < left; ++i) {
        const std::int64_t row = candidates.rows + (worker.left[i] & 0xffff),
                           column = candidates.columns + (worker.left[i] >> 16);
        if (check && !ours(row, column)) continue;
        for_each_test(
            builder.sorted[row], builder.sorted[column], name, [&](const FeatureTest& t) { vertex_faces.push_back(t); },
            [&](const FeatureTest& t) { edge_edges.push_back(t); });
    }
}

template <int moments>
void FeatureLeaves<moments>::decide_tests(FeatureKind kind, Worker& worker) {
    const auto k = static_cast<std::size_t>(kind);
    FeatureCounts counts;
    for (const FeatureTest& test : worker.tests[k]) {
        const FeatureDecision decision = decide(kind, points_of(call_->scene, test.vertex), *query_, counts);
        if (!decision.hit) continue;
        any_.store(true, std::memory_order_relaxed);
        if (query_->extent == Extent::any) break;
        worker.hits[k].push_back({test.pair, decision.value, decision.flag});
    }
    worker.statistics.exact_tests += counts.tests;
    worker.statistics.rational_tests += counts.rational;
}

template <int moments>
void FeatureLeaves<moments>::finish(Statistics& statistics) {
    for (const auto& worker : worker_) add(worker->statistics, statistics);
}

template class FeatureLeaves<1>;
template class FeatureLeaves<2>;

}  // namespace crumple::cpu
