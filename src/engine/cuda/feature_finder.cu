#include "engine/cuda/feature_finder.h"

#include <algorithm>
#include <bit>

#include "engine/feature_output.h"
#include "questions/features/decide.h"

namespace crumple::cuda {
namespace {

constexpr std::size_t batch = 4096;  // cases that the host decides at once

}  // namespace

FeatureFinder::FeatureFinder(const Device& device, const Geometry& geometry, cudaStream_t stream,
                             const Options& options, MemoryMeter& meter, Cancellation& cancellation, Input& input)
    : options_(options),
      meter_(meter),
      cancellation_(cancellation),
      geometry_(geometry),
      stream_(stream),
      input_(input),
      features_(stream, meter),
      watch_(device),
      beside_(device),
      counters_(device),
      guides_(meter),
      work_(meter),
      answer_(meter),
      pass_(geometry, stream, options) {
    pass_.beside = &beside_;
}

void FeatureFinder::drop_lists() {
    laid_out_.reset();
    work_.release();
    answer_.release();
}

void FeatureFinder::release() {
    drop_lists();
    guides_.release();
    features_.release();
    planned_for_ = {};
    too_many_ = std::numeric_limits<std::int64_t>::max();
}

// Whether there was memory for the work.
template <class Work>
bool FeatureFinder::fits(Work work) {
    try {
        work();
        return true;
    } catch (const MemoryMeter::Exceeded&) {
    } catch (const OutOfDeviceMemory&) {
    }
    return false;
}

void FeatureFinder::find(const Scene& scene, const FeatureQuery& query, FeatureAnswer& answer) {
    clear(answer);
    adopt(scene, query);
    const std::int64_t n = pass_.scene.triangle_count();
    if (query.frugal) {
        find_in_chunks(answer, Lists::shortest);
    } else if (n >= too_many_ || !fits([&] { find_at_once(answer); })) {
        too_many_ = std::min(too_many_, n);
        if (!fits([&] { find_in_chunks(answer, Lists::roomy); })) find_in_chunks(answer, Lists::shortest);
    }
    answer.statistics = statistics_;
}

void FeatureFinder::adopt(const Scene& scene, const FeatureQuery& query) {
    query_ = &query;
    input_.bring(scene);
    input_.want(query.rule);
    features_.bring(scene, query);
    pass_.scene = input_.scene();
    pass_.box = input_.box();
    pass_.groups = input_.groups_wanted();
    pass_.asked = features_.asked();
    pass_.all_kinds = features_.all_kinds();
    pass_.primitives = {true, scene.moving, scene.moving ? static_cast<std::int32_t>(scene.vertex_count()) : 0,
                        pass_.asked.inflation, false};
    statistics_ = {};
}

void FeatureFinder::plan() {
    const SceneKind kind{pass_.scene.triangle_count(), query_->motion, pass_.all_kinds};
    if (planned_for_ != kind) pass_.plan.choose_features(kind.triangles, kind.all_kinds, options_);
    planned_for_ = kind;
}

void FeatureFinder::lay_out_lists() {
    const Layout wanted{pass_.scene.vertex_count(),
                        pass_.scene.triangle_count(),
                        pass_.scene.float32,
                        pass_.scene.moving,
                        pass_.plan,
                        features_.firsts(),
                        query_->extent};
    if (laid_out_ == wanted) return;
    laid_out_.reset();
    lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
    lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
    lay_out(answer_, [&](Cutter& c) {
        earliest_ = c.take<Earliest>(1);
        output_.cut(c, features_.firsts(), query_->extent == Extent::all ? pass_.plan.hits : 0);
    });
    laid_out_ = wanted;
}

FeatureHits FeatureFinder::hits() const {
    return {query_->extent == Extent::any, pass_.hits(), output_.offsets, output_.by_tile, features_.firsts()};
}

void FeatureFinder::find_at_once(FeatureAnswer& answer) {
    plan();
    do {
        cancellation_.check();
        lay_out_lists();
        enqueue();
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
    } while (!accept());
    watch_.read(statistics_);
    answer.any = counters_->hits > 0;
    if (query_->extent != Extent::any && query_->motion) tell_earliest(answer);
    if (query_->extent == Extent::all) copy_to(answer);
}

void FeatureFinder::enqueue() {
    Clearing clearing;
    output_.clear(clearing);
    cuda::clear(clearing, earliest_);
    enqueue_until_sorted(clearing);
    watch_.begin(Stage::sweep, stream_);
    pass_.sweep({0, 1, 1, hits().end()});
    watch_.begin(Stage::narrow, stream_);
    output_.hits = pass_.hits().data;
    pass_.narrow(hits());
    watch_.begin(Stage::output, stream_);
    if (query_->extent == Extent::all) write_answer(geometry_, stream_, hits(), output_, pass_.counters, nullptr);
    if (query_->extent != Extent::any && query_->motion)
        find_earliest(geometry_, stream_, hits(), earliest_, pass_.counters, nullptr);
    if (pass_.plan.guided) beside_.join(stream_);
    watch_.end(stream_);
    CRUMPLE_CUDA(cudaMemcpyAsync(counters_.get(), pass_.counters, sizeof(Counters), cudaMemcpyDeviceToHost, stream_));
}

void FeatureFinder::enqueue_until_sorted(Clearing& clearing) {
    pass_.clear(clearing);
    input_.clear(clearing);
    clearing.launch(geometry_, stream_);
    watch_.begin(Stage::bounds, stream_);
    input_.enqueue(geometry_, stream_, pass_.counters);
    features_.enqueue(geometry_, stream_, pass_.scene, pass_.box);
    pass_.bounds();
    watch_.begin(Stage::subdivide, stream_);
    pass_.subdivide_scene();
    pass_.subdivide_clusters(~std::uint64_t{0});
    watch_.begin(Stage::align, stream_);
    pass_.align();
    watch_.begin(Stage::sort, stream_);
    pass_.sort();
}

// Whether the pass was complete. If not, the plan is another one. Where nothing but a hit is asked for and there is
// one, lists may be short: each hit is a proof of its own.
bool FeatureFinder::accept() {
    Counters& counters = *counters_;
    input_.throw_error(counters);
    const std::int64_t n = pass_.scene.triangle_count();
    const bool proven = query_->extent == Extent::any && counters.hits > 0;
    const bool complete = pass_.plan.accepts(counters, n, options_, query_->extent != Extent::any);
    if (!complete && !proven) return false;
    if (complete && !proven && counters.beyond > 0) {
        const std::vector<RankedHit> found = decide_beyond(static_cast<std::size_t>(counters.beyond));
        const unsigned long long before = counters.hits;
        counters.hits += found.size();
        if (query_->extent != Extent::any && !found.empty()) {
            if (!pass_.plan.accepts_hits(counters.hits)) return false;
            write_again(found, before);
        }
    }
    count(counters);
    if (complete) {
        pass_.plan.cold = false;
        pass_.plan.guided = true;
    }
    return true;
}

// The answer once more, with what the host has found.
void FeatureFinder::write_again(const std::vector<RankedHit>& found, unsigned long long before) {
    Block block(meter_);
    RankedHit* device = nullptr;
    lay_out(block, [&](Cutter& c) { device = c.take<RankedHit>(found.size()); });
    copy_now(stream_, device, found.data(), found.size(), cudaMemcpyHostToDevice);
    Clearing clearing;
    output_.clear(clearing);
    cuda::clear(clearing, earliest_);
    clearing.add(&pass_.counters->parts, sizeof pass_.counters->parts);
    clearing.launch(geometry_, stream_);
    append_hits(geometry_, stream_, device, found.size(), before, hits());
    rank_hits(geometry_, stream_, hits());
    if (query_->extent == Extent::all) write_answer(geometry_, stream_, hits(), output_, pass_.counters, nullptr);
    if (query_->motion) find_earliest(geometry_, stream_, hits(), earliest_, pass_.counters, nullptr);
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
}

// What no filter of the device could tell, in rational arithmetic.
std::vector<RankedHit> FeatureFinder::decide_beyond(std::size_t count) {
    std::vector<RankedHit> found;
    std::vector<FeatureCase> cases(std::min(count, batch));
    Block block(meter_);
    FeatureCase* device = nullptr;
    lay_out(block, [&](Cutter& c) { device = c.take<FeatureCase>(cases.size()); });
    fill(stream_, device, 0, cases.size() * sizeof(FeatureCase));  // what lies between members is copied, too
    for (std::size_t begin = 0; begin < count; begin += batch) {
        const std::size_t some = std::min(batch, count - begin);
        pack_cases(geometry_, stream_, pass_.scene, pass_.asked, pass_.beyond() + begin, some, device);
        copy_now(stream_, cases.data(), device, some, cudaMemcpyDeviceToHost);
        for (std::size_t i = 0; i < some; ++i) {
            cancellation_.check();
            FeatureCounts counts;
            const FeatureDecision decision = decide(cases[i], *query_, counts);
            if (!decision.hit) continue;
            const std::uint32_t base = features_.firsts().base[static_cast<std::size_t>(cases[i].kind)];
            found.push_back({base + static_cast<std::uint32_t>(cases[i].pair.a), cases[i].pair.b, 0, decision.flag,
                             decision.value});
            if (query_->extent == Extent::any) return found;
        }
    }
    return found;
}

Counters FeatureFinder::read_counters() {
    copy_now(stream_, counters_.get(), pass_.counters, 1, cudaMemcpyDeviceToHost);
    return *counters_;
}

void FeatureFinder::count(const Counters& c) {
    Statistics& s = statistics_;
    s.backend = "cuda";
    s.clusters = pass_.plan.fan_out[0];
    s.leaves = pass_.plan.leaves();
    s.members += static_cast<std::int64_t>(c.members[pass_.plan.levels() - 1]);
    s.interval_tests += static_cast<std::int64_t>(c.interval_tests);
    s.box_overlaps += static_cast<std::int64_t>(c.box_overlaps);
    s.edge_tests += static_cast<std::int64_t>(c.listed);
    for (const unsigned long long tests : c.tests) {
        s.double_tests += static_cast<std::int64_t>(tests);
        s.exact_tests += static_cast<std::int64_t>(tests);
    }
    s.rational_tests += static_cast<std::int64_t>(c.beyond);
}

void FeatureFinder::tell_earliest(FeatureAnswer& answer) {
    Earliest first{};
    copy_now(stream_, &first, earliest_, 1, cudaMemcpyDeviceToHost);
    if (counters_->hits == 0) return;
    const auto joint = static_cast<std::uint32_t>(first.pair >> 32);
    const FirstOfKind& firsts = features_.firsts();
    std::size_t kind = 0;
    while (joint >= firsts.base[kind + 1]) ++kind;
    answer.first = {true,
                    static_cast<FeatureKind>(kind),
                    {static_cast<std::int32_t>(joint - firsts.base[kind]), static_cast<std::int32_t>(first.pair)},
                    {},
                    std::bit_cast<double>(first.value),
                    first.flag != 0};
}

void FeatureFinder::copy_to(FeatureAnswer& answer) {
    const FirstOfKind& firsts = features_.firsts();
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        unsigned long long ends[2] = {};
        copy_now(stream_, &ends[0], output_.offsets + firsts.base[k], 1, cudaMemcpyDeviceToHost);
        copy_now(stream_, &ends[1], output_.offsets + firsts.base[k + 1], 1, cudaMemcpyDeviceToHost);
        const auto begin = static_cast<std::size_t>(ends[0]), count = static_cast<std::size_t>(ends[1] - ends[0]);
        FeatureRows& rows = answer.rows[k];
        const auto copy = [&](auto& array, const auto* device) {
            copy_now(stream_, array.resize_discard(count), device + begin, count, cudaMemcpyDeviceToHost);
        };
        copy(rows.pairs, output_.pairs);
        copy(rows.value, output_.value);
        copy(rows.flag, output_.flag);
    }
}

// A quarter of what memory is left, for members and what is found grow, too.
std::int64_t FeatureFinder::bytes_left() const {
    std::size_t free = 0, total = 0;
    CRUMPLE_CUDA(cudaMemGetInfo(&free, &total));
    const auto left = static_cast<std::int64_t>(free);
    return (meter_.limit > 0 ? std::clamp<std::int64_t>(meter_.limit - meter_.used, 0, left) : left) / 4;
}

void FeatureFinder::lay_out_chunks() {
    lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
    lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
    lay_out(answer_, [&](Cutter& c) { output_.cut(c, features_.firsts(), 0); });
    Clearing clearing;
    pass_.clear(clearing);
    input_.clear(clearing);
    output_.clear(clearing);
    clearing.launch(geometry_, stream_);
    input_.enqueue(geometry_, stream_, pass_.counters);
    features_.enqueue(geometry_, stream_, pass_.scene, pass_.box);
    pass_.bounds();
    input_.throw_error(read_counters());
    pass_.subdivide_scene();
}

void FeatureFinder::find_in_chunks(FeatureAnswer& answer, Lists lists) {
    drop_lists();
    clear(answer);
    planned_for_ = {};
    statistics_ = {};
    constexpr std::size_t of_test = 2 * sizeof(FeatureTest) + sizeof(OpenTest) + sizeof(RankedHit);
    pass_.plan.choose_feature_chunks(pass_.scene.triangle_count(), pass_.all_kinds, options_,
                                     lists == Lists::roomy ? bytes_left() : 0, of_test);
    Array<RankedHit> found(&meter_);
    bool laid_out = false;
    for (int k = 0; k < pass_.plan.fan_out[0];) {
        if (!laid_out) lay_out_chunks();
        Clearing clearing;
        pass_.clear(clearing);
        clearing.launch(geometry_, stream_);
        pass_.subdivide_clusters(std::uint64_t{1} << k);
        laid_out = pass_.plan.accepts_chunk(read_counters());
        if (!laid_out) continue;
        pass_.align();
        pass_.sort();
        const Counters sorted = read_counters();
        laid_out = pass_.plan.accepts_units(sorted);
        if (!laid_out) continue;
        count(sorted);
        pass_over_slices(found, answer);
        if (query_->extent == Extent::any && answer.any) break;
        ++k;
    }
    drop_lists();
    write_sorted(found, answer);
}

// A slice is halved until its pairs of triangles fit their list; then all lists fit.
void FeatureFinder::pass_over_slices(Array<RankedHit>& found, FeatureAnswer& answer) {
    for (Slice slice{}; slice.turn < slice.turns;) {
        cancellation_.check();
        pass_.clear_counters();
        pass_.sweep(slice);
        if (read_counters().survivors > pass_.plan.survivors) {
            slice = {2 * slice.turn, 2 * slice.turns};
            continue;
        }
        pass_.narrow(hits());
        const Counters counters = read_counters();
        count(counters);
        answer.any = answer.any || counters.hits > 0;
        if (query_->extent == Extent::any && answer.any) return;
        const auto listed = static_cast<std::size_t>(counters.hits), before = found.size();
        if (query_->extent != Extent::any) {
            found.resize(before + listed);
            copy_now(stream_, found.data() + before, pass_.hits().data, listed, cudaMemcpyDeviceToHost);
        }
        if (counters.beyond > 0)
            for (const RankedHit& hit : decide_beyond(static_cast<std::size_t>(counters.beyond))) {
                answer.any = true;
                if (query_->extent == Extent::any) return;
                found.push_back(hit);
            }
        ++slice.turn;
    }
}

void FeatureFinder::write_sorted(Array<RankedHit>& found, FeatureAnswer& answer) const {
    const auto pair = [](const RankedHit& hit) { return std::pair(hit.first, hit.second); };
    if (query_->extent == Extent::any) return;
    std::sort(found.begin(), found.end(), [&](const RankedHit& a, const RankedHit& b) { return pair(a) < pair(b); });
    const RankedHit* hit = found.begin();
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const std::uint32_t base = features_.firsts().base[k];
        FeatureRows& rows = answer.rows[k];
        for (; hit != found.end() && hit->first < features_.firsts().base[k + 1]; ++hit) {
            const Pair features{static_cast<std::int32_t>(hit->first - base), hit->second};
            const FirstImpact impact{true, static_cast<FeatureKind>(k), features, {}, hit->value, hit->flag != 0};
            if (query_->motion && (!answer.first.found || impact.toi < answer.first.toi)) answer.first = impact;
            if (query_->extent != Extent::all) continue;
            rows.pairs.push_back(features);
            rows.value.push_back(hit->value);
            rows.flag.push_back(static_cast<std::uint8_t>(hit->flag));
        }
    }
}

}  // namespace crumple::cuda
