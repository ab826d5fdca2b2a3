#include "backends/cpu/features/feature_leaves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "backends/cpu/order.h"
#include "base/float_environment.h"
#include "base/stopwatch.h"
#include "filters/features/codimensional_tests.h"
#include "filters/features/separating_direction.h"
#include "results/intersection_output.h"

namespace crumple::cpu {
namespace {

// Number of pairs of triangles whose tests are listed at once.
constexpr std::size_t pairs_at_once = 256;

// A worker with this many hits delivers them to the stream before their unit ends.
constexpr std::size_t rows_of_piece = 2048;

// Returns the record of rows without a member. It owns nothing, so no pair with it has a test.
template <int moments>
FeatureRecord<moments> dummy_record() {
    FeatureRecord<moments> record{};
    for (int k = 0; k < 3; ++k) record.vertex[k] = record.edge[k] = -1;
    record.triangle = -1;
    return record;
}

float largest_radius(const BuildInput& input) {
    float largest = 0;
    for (std::int64_t i = 0; i < input.members; ++i)
        largest = std::max(largest, input.inflation.radius[input.triangle[i]]);
    return largest;
}

// Computes the distance requested in each test: the sum of both features' largest vertex radii. The rounding error of
// a sum is less than the amount by which its radii were rounded up.
void add_radii(FeatureKind kind, const Array<FeatureTest>& tests, const float* radius, Array<float>& distance) {
    distance.resize_discard(tests.size() + padding);
    for (std::size_t i = 0; i < tests.size(); ++i) {
        const std::int32_t* v = tests[i].vertex;
        const float second = radius[v[1]], last = std::max(radius[v[2]], radius[v[3]]);
        distance[i] = kind == FeatureKind::edge_edge ? std::max(radius[v[0]], second) + last
                                                     : radius[v[0]] + std::max(second, last);
    }
    std::fill(distance.end() - padding, distance.end(), 0.0f);
}

/// Returns the rank of a pair in the order that decides between equal times: by kind, first and second feature.
std::uint64_t place_of(FeatureKind kind, const Pair& pair) {
    return static_cast<std::uint64_t>(kind) << 62 | static_cast<std::uint64_t>(pair.a) << 31 |
           static_cast<std::uint64_t>(pair.b);
}

void lower(std::atomic<std::uint64_t>& least, std::uint64_t value) {
    std::uint64_t known = least.load(std::memory_order_relaxed);
    while (value < known && !least.compare_exchange_weak(known, value, std::memory_order_relaxed)) continue;
}

}  // namespace

template <int moments>
FeatureLeaves<moments>::FeatureLeaves(MemoryMeter* meter, int workers, const FeatureTables& kernels)
    : tables_(kernels), kernels_(kernels.of<moments>()) {
    for (int w = 0; w < workers; ++w) {
        worker_.push_back(std::make_unique<Worker>(meter));
        for (std::size_t k = 0; k < feature_kinds; ++k)
            found_[k].push_back(&worker_.back()->hits[static_cast<FeatureKind>(k)]);
    }
}

template <int moments>
void FeatureLeaves<moments>::ask(const FeatureRequest& query, float distance, const float* radius) {
    query_ = &query;
    distance_ = distance;
    share_ = share_to_filter(query.share);
    radius_ = radius;
    stream_ = nullptr;
}

template <int moments>
void FeatureLeaves<moments>::begin(const Call& call) {
    call_ = &call;
    any_ = false;
    first_at_start_ = no_place;
    first_time_ = std::bit_cast<std::uint64_t>(1.0);
    for (const auto& worker : worker_) {
        worker->hits.clear();
        for (auto& list : worker->tests) list.clear();  // not every kind is listed in every call
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
    BuildInput searched = input;
    if (moments == 2 && query_->extent == Extent::first) searched.until = first_time();
    kernels_.build(searched, query_->features, worker.built.data(), members.boxes, members.bounds);
    worker.reach = (searched.until < 1 ? 2 : 1) * members.bounds.reach;
    worker.farthest = radius_ ? 2 * largest_radius(input) : distance_;
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
    CandidateChunk& candidates = worker.candidates;
    Statistics& statistics = worker.statistics;
    Stopwatch watch;
    const auto should_stop = [&] {
        watch.lap();
        return stop();
    };
    sweep_chunks(call_->kernels, leaf, first, last, candidates, should_stop, [&] {
        statistics[Stage::sweep] += watch.lap();
        if (candidates.pairs == 0) return;
        statistics.box_overlaps += candidates.pairs;
        narrow(leaf, ownership, *worker_[builder], worker);
        statistics[Stage::narrow] += watch.lap();
    });
}

// Runs stage `narrow` for one chunk of candidates, in batches of pairs, so that tests stay in the cache.
template <int moments>
void FeatureLeaves<moments>::narrow(const SortedLeaf& leaf, const Ownership& ownership, const Worker& builder,
                                    Worker& worker) {
    const std::size_t left = separate(builder, worker);
    if (!ownership.complete() || !call_->rule.trivial())
        return narrow(own_pairs(leaf, ownership, left, worker), builder, worker);
    narrow(left, builder, worker);
}

template <int moments>
void FeatureLeaves<moments>::narrow(std::size_t pairs, const Worker& builder, Worker& worker) {
    const Record* rows = builder.sorted.data() + worker.candidates.rows;
    const Record* columns = builder.sorted.data() + worker.candidates.columns;
    for (std::size_t first = 0; first < pairs; first += pairs_at_once) {
        const PairsLeft<moments> some{rows, columns, worker.left.data() + first,
                                      std::min(pairs_at_once, pairs - first)};
        find_tests(some, worker);
        for (std::size_t k = 0; k < feature_kinds; ++k) decide_tests(static_cast<FeatureKind>(k), worker);
        if (stream_ && worker.hits.size() >= rows_of_piece) stream_->add(worker.unit, worker.hits);
    }
}

// Lists the candidates that no direction separates; returns their number.
template <int moments>
std::size_t FeatureLeaves<moments>::separate(const Worker& builder, Worker& worker) const {
    worker.left.resize_discard(static_cast<std::size_t>(worker.candidates.count + padding));
    const FlushToZero mode;
    const NeededGap gap(builder.farthest, builder.reach, share_);
    return kernels_.separate(builder.sorted.data(), worker.candidates, gap, worker.left.data());
}

// Keeps the pairs that the leaf owns and the pair filter selects; returns their number.
template <int moments>
std::size_t FeatureLeaves<moments>::own_pairs(const SortedLeaf& leaf, const Ownership& ownership, std::size_t left,
                                              Worker& worker) const {
    const PreparedScene& scene = call_->scene;
    const SceneFilter& rule = call_->rule;
    const auto foreign = [&](std::uint32_t packed) {
        const std::int64_t row = worker.candidates.rows + (packed & 0xffff),
                           column = worker.candidates.columns + (packed >> 16);
        const std::int32_t a = leaf.link[row].triangle, b = leaf.link[column].triangle;
        if (!ownership.complete() && !ownership.owns(a, leaf.member[row], b, leaf.member[column])) return true;
        return !rule.trivial() && !rule(scene.group(a), scene.group(b));
    };
    const auto begin = worker.left.begin();
    return static_cast<std::size_t>(std::remove_if(begin, begin + left, foreign) - begin);
}

// Lists the tests of pairs, and drops those that the filters decide.
template <int moments>
void FeatureLeaves<moments>::find_tests(const PairsLeft<moments>& pairs, Worker& worker) const {
    const SceneFeatures& features = query_->features;
    if (!features.plain()) {
        list_codimensional_tests(pairs, worker);
        for (std::size_t k = 0; k < feature_kinds; ++k) filter_tests(static_cast<FeatureKind>(k), worker);
        return;
    }
    constexpr std::size_t most[] = {6, 9};
    TestList listed[2];
    for (std::size_t k = 0; k < 2; ++k)
        listed[k].test = worker.listed[k].resize_discard(most[k] * pairs_at_once + padding);
    kernels_.list(pairs, features.is_welded() ? features.names().data() : nullptr, listed[0], listed[1]);
    filter_list<FeatureKind::vertex_face>(pairs, listed[0], worker);
    filter_list<FeatureKind::edge_edge>(pairs, listed[1], worker);
}

template <int moments>
template <FeatureKind kind>
void FeatureLeaves<moments>::filter_list(const PairsLeft<moments>& pairs, TestList& listed, Worker& worker) const {
    constexpr auto k = static_cast<std::size_t>(kind);
    Array<FeatureTest>& tests = worker.tests[k];
    FeatureTest* test = tests.resize_discard(listed.count);
    if (radius_) {
        for (std::size_t i = 0; i < listed.count; ++i) write_test<kind>(pairs, listed, i, test[i]);
        return filter_tests(kind, worker);
    }
    worker.statistics.edge_tests += static_cast<std::int64_t>(listed.count);
    const FlushToZero mode;
    tests.resize(kernels_.filter_list[k](call_->points(), ends(), {distance_, share_}, pairs, listed, test));
    drop_adjacent(kind, tests);
}

// Lists the tests of pairs in a scene whose features are not plain (SceneFeatures::plain).
template <int moments>
void FeatureLeaves<moments>::list_codimensional_tests(const PairsLeft<moments>& pairs, Worker& worker) const {
    constexpr std::size_t most[feature_kinds] = {6, 9, 4, 1};
    const FeatureTable features = query_->features.table();
    const auto name = [&](std::int32_t vertex) { return features.name(vertex); };
    std::array<FeatureTest*, feature_kinds> next;
    for (std::size_t k = 0; k < feature_kinds; ++k) next[k] = worker.tests[k].resize_discard(most[k] * pairs_at_once);
    for (std::size_t pair = 0; pair < pairs.count; ++pair)
        crumple::list_codimensional_tests(pairs.row(pair), pairs.column(pair), features, name, next);
    for (std::size_t k = 0; k < feature_kinds; ++k)
        worker.tests[k].resize(static_cast<std::size_t>(next[k] - worker.tests[k].data()));
}

template <int moments>
void FeatureLeaves<moments>::filter_tests(FeatureKind kind, Worker& worker) const {
    const auto k = static_cast<std::size_t>(kind);
    Array<FeatureTest>& tests = worker.tests[k];
    worker.statistics.edge_tests += static_cast<std::int64_t>(tests.size());
    const FlushToZero mode;
    if (radius_) add_radii(kind, tests, radius_, worker.distance);
    const RequestedDistance asked =
        radius_ ? RequestedDistance(worker.distance.data()) : RequestedDistance(distance_, share_);
    tests.resize(kernels_.filter[k](call_->points(), ends(), asked, tests.data(), tests.size()));
    drop_adjacent(kind, tests);
}

// Returns BuildInput::ends.
template <int moments>
std::int64_t FeatureLeaves<moments>::ends() const {
    return call_->scene.moving ? call_->scene.vertex_count() : 0;
}

template <int moments>
void FeatureLeaves<moments>::drop_adjacent(FeatureKind kind, Array<FeatureTest>& tests) const {
    if (!query_->rings) return;
    const auto neighbours = [&](const FeatureTest& test) { return are_adjacent(kind, test.vertex, *query_); };
    tests.resize(static_cast<std::size_t>(std::remove_if(tests.begin(), tests.end(), neighbours) - tests.begin()));
}

template <int moments>
void FeatureLeaves<moments>::decide_tests(FeatureKind kind, Worker& worker) {
    const auto k = static_cast<std::size_t>(kind);
    const Array<FeatureTest>& tests = worker.tests[k];
    if (tests.empty()) return;
    worker.statistics.double_tests += static_cast<std::int64_t>(tests.size());
    if (query_->criterion == Criterion::proximity && query_->extent == Extent::all) return measure_tests(kind, worker);
    FeatureCounts counts;
    const bool first_alone = query_->extent == Extent::first;
    for (const FeatureTest& test : tests) {
        if (first_alone && place_of(kind, test.pair) > first_at_start_.load(std::memory_order_relaxed)) continue;
        if (first_alone && is_later(kind, test)) continue;
        const std::int64_t rational = counts.rational;
        const FeatureDecision decision = decide(kind, call_->scene, test.vertex, *query_, counts);
        if (counts.rational != rational) call_->cancellation.check();  // some decisions take a millisecond
        if (!decision.hit) continue;
        any_.store(true, std::memory_order_relaxed);
        if (query_->extent == Extent::any) break;
        if (first_alone && decision.value == 0) lower(first_at_start_, place_of(kind, test.pair));
        if (first_alone) lower(first_time_, std::bit_cast<std::uint64_t>(decision.value));
        worker.hits[kind].push_back({test.pair, decision.value, decision.flag});
    }
    worker.statistics.exact_tests += counts.tests;
    worker.statistics.rational_tests += counts.rational;
}

// Returns a float32 upper bound, at least 1e-30, of the earliest toi found so far; 1 if none below 1 was found.
template <int moments>
float FeatureLeaves<moments>::first_time() const {
    const double known = std::bit_cast<double>(first_time_.load(std::memory_order_relaxed));
    return known < 1 ? std::max(std::nextafter(static_cast<float>(known), 1.0f), 1e-30f) : 1.0f;
}

// Returns true if an impact of this test would be later than the earliest one found so far. Times are not negative, so
// their bits have the same order.
template <int moments>
bool FeatureLeaves<moments>::is_later(FeatureKind kind, const FeatureTest& test) const {
    const double known = std::bit_cast<double>(first_time_.load(std::memory_order_relaxed));
    return known < 1 && surely_later(kind, call_->scene, test.vertex, *query_, known);
}

// Decides tests of proximity. Lanes measure the distances of near features; those that lanes cannot decide are measured
// one by one.
template <int moments>
void FeatureLeaves<moments>::measure_tests(FeatureKind kind, Worker& worker) {
    const auto k = static_cast<std::size_t>(kind);
    GuessBatch& batch = worker.guesses;
    FeatureCounts counts;
    const Array<FeatureTest>& tests = worker.tests[k];
    std::size_t near[GuessBatch::most] = {};  // indices of the tests in the batch
    const auto measure = [&] {
        double squared[GuessBatch::most] = {};
        tables_.squared(batch, squared);
        for (std::size_t i = 0; i < batch.count; ++i) {
            FeatureDecision decision{true, squared[i], false};
            FeatureCounts again;
            if (std::isnan(squared[i])) decision = decide(kind, call_->scene, tests[near[i]].vertex, *query_, again);
            counts.rational += again.rational;
            worker.hits[kind].push_back({tests[near[i]].pair, decision.value, decision.flag});
        }
        batch.count = 0;
    };
    for (std::size_t i = 0; i < tests.size(); ++i) {
        const FeatureTest& test = tests[i];
        const std::int64_t rational = counts.rational;
        const auto decision = decide_or_add(kind, call_->scene, test.vertex, *query_, counts, batch);
        if (!decision) near[batch.count - 1] = i;
        if (decision && decision->hit) worker.hits[kind].push_back({test.pair, decision->value, decision->flag});
        if (batch.count == GuessBatch::most) measure();
        if (counts.rational != rational) call_->cancellation.check();  // some decisions take a millisecond
    }
    measure();
    if (worker.hits[kind].size() > 0) any_.store(true, std::memory_order_relaxed);
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
