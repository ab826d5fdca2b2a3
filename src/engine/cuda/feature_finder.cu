#include "engine/cuda/feature_finder.h"

#include <algorithm>
#include <bit>

#include "engine/feature_output.h"
#include "questions/features/decide.h"

namespace crumple::cuda {
namespace {

constexpr std::size_t batch = 4096;  // cases that the host decides at once

}  // namespace

void FeatureFinder::release() {
    Finder::release();
    features_.release();
    laid_out_.reset();
    planned_for_ = {};
}

void FeatureFinder::find(const Scene& scene, const FeatureQuery& query, FeatureAnswer& answer) {
    clear(answer);
    answer.statistics.backend = "cuda";
    if (scene.triangle_count() == 0) return;  // lists have a least size, which no limit need hold for nothing
    adopt(scene, query);
    Finder::find(
        query.frugal, [&] { find_at_once(answer); }, [&](Lists lists) { find_in_chunks(answer, lists); });
    answer.statistics = statistics_;
}

void FeatureFinder::adopt(const Scene& scene, const FeatureQuery& query) {
    query_ = &query;
    bring(scene, query.rule);
    features_.bring(scene, query);
    pass_.asked = features_.asked();
    pass_.all_kinds = features_.all_kinds();
    pass_.primitives = primitives(scene, pass_.asked.inflation, false);
}

void FeatureFinder::plan() {
    const SceneKind kind{pass_.scene.triangle_count(), pass_.all_kinds};
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
    enqueue_until_sorted(clearing, [&] { features_.enqueue(geometry_, stream_, pass_.scene, pass_.box); });
    watch_.begin(Stage::sweep, stream_);
    pass_.sweep({0, 1, 1, hits().end()});
    watch_.begin(Stage::narrow, stream_);
    output_.hits = pass_.hits().data;
    pass_.narrow(hits());
    watch_.begin(Stage::output, stream_);
    if (query_->extent == Extent::all) write_answer(geometry_, stream_, hits(), output_, pass_.counters, nullptr);
    if (query_->extent != Extent::any && query_->motion)
        find_earliest(geometry_, stream_, hits(), earliest_, pass_.counters, nullptr);
    enqueue_end();
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
    if (complete) accepted();
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
    std::vector<PackedFeatures> cases(std::min(count, batch));
    Block block(meter_);
    PackedFeatures* device = nullptr;
    lay_out(block, [&](Cutter& c) { device = c.take<PackedFeatures>(cases.size()); });
    fill(stream_, device, 0, cases.size() * sizeof(PackedFeatures));  // what lies between members is copied, too
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

void FeatureFinder::find_in_chunks(FeatureAnswer& answer, Lists lists) {
    drop_lists();
    laid_out_.reset();
    planned_for_ = {};
    clear(answer);
    statistics_ = {};
    constexpr std::size_t of_test = 2 * sizeof(FeatureTest) + sizeof(OpenTest) + sizeof(RankedHit);
    pass_.plan.choose_feature_chunks(pass_.scene.triangle_count(), pass_.all_kinds, options_,
                                     lists == Lists::roomy ? bytes_for_lists(meter_) : 0, of_test);
    Array<RankedHit> found(&meter_);
    const auto cut = [&](Cutter& c) { output_.cut(c, features_.firsts(), 0); };
    const auto make_ready = [&] { features_.enqueue(geometry_, stream_, pass_.scene, pass_.box); };
    over_chunks(cut, make_ready, [&] { return take_slice(found, answer); });
    drop_lists();
    write_sorted(found, answer);
}

// False once nothing more is wanted.
bool FeatureFinder::take_slice(Array<RankedHit>& found, FeatureAnswer& answer) {
    const bool any = query_->extent == Extent::any;
    pass_.narrow(hits());
    const Counters counters = read_counters();
    count(counters);
    answer.any = answer.any || counters.hits > 0;
    if (any && answer.any) return false;
    const auto listed = static_cast<std::size_t>(counters.hits), before = found.size();
    if (!any) {
        found.resize(before + listed);
        copy_now(stream_, found.data() + before, pass_.hits().data, listed, cudaMemcpyDeviceToHost);
    }
    if (counters.beyond == 0) return true;
    for (const RankedHit& hit : decide_beyond(static_cast<std::size_t>(counters.beyond))) {
        answer.any = true;
        if (!any) found.push_back(hit);
    }
    return !(any && answer.any);
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
