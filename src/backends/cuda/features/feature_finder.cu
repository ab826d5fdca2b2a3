#include "backends/cuda/features/feature_finder.h"

#include <algorithm>
#include <bit>

#include "backends/decide_features.h"
#include "results/feature_output.h"

namespace crumple::cuda {
namespace {

constexpr std::size_t batch = 4096;  // cases that the host decides at once

}  // namespace

void FeatureSlot::ask(const FeatureRequest& asked) {
    query.emplace(asked);
    if (!asked.rest) return;
    rest = *asked.rest;
    query->rest = &rest;
}

void FeatureFinder::release() {
    Finder::release();
    for (FeatureSlot& slot : slots_) {
        slot.features.release();
        slot.host = FeatureAnswer(&meter_);
    }
    planned_for_ = {};
}

void FeatureFinder::bring(std::size_t to, const PreparedScene& scene, const FeatureRequest& query) {
    take_slot(to);
    input().bring(scene);
    input().want(query.rule);
    slot().features.bring(scene, query, features_);
    adopt(query);
}

void FeatureFinder::view(std::size_t to, const Shape& shape, const FeatureRequest& query, Room room) {
    take_slot(to);
    features_.bring(query.features, shape.vertices.rows, room);
    input().view(shape, features_.known(), room);
    input().want(query.rule, room);
    slot().features.view(input().scene(), query, features_, room);
    adopt(query);
}

void FeatureFinder::adopt(const FeatureRequest& query) {
    slot().ask(query);
    slot().frugal = query.frugal;
    slot().revision = query.features.revision();
    look();
}

void FeatureFinder::look() {
    Finder::look();
    pass_.asked = slot().features.asked();
    pass_.all_kinds = slot().features.all_kinds();
    pass_.primitives = primitives(pass_.scene, pass_.asked.inflation, false);
}

void FeatureFinder::plan() {
    const SceneKind kind{pass_.scene.triangle_count(), pass_.all_kinds};
    if (planned_for_ != kind) pass_.plan.choose_features(kind.triangles, kind.all_kinds, options_);
    planned_for_ = kind;
}

void FeatureFinder::cut_answer(Cutter& c) {
    slot().earliest = c.take<Earliest>(1);
    slot().output.cut(c, firsts(), query().extent == Extent::all ? pass_.plan.hits : 0);
}

FeatureHits FeatureFinder::hits() const {
    const FeatureOutput& output = slot().output;
    return {query().extent == Extent::any, pass_.hits(), output.offsets, output.by_tile, firsts()};
}

void FeatureFinder::enqueue(StageEvents* watch) {
    const bool all = query().extent == Extent::all, earliest = query().extent != Extent::any && query().motion;
    FeatureOutput& output = slot().output;
    Counters* const told = slot().counters.get();
    Clearing clearing;
    output.clear(clearing);
    cuda::clear(clearing, slot().earliest);
    enqueue_until_sorted(clearing, watch,
                         [&] { slot().features.enqueue(geometry_, stream_, pass_.scene, pass_.box, pass_.counters); });
    begin(watch, Stage::sweep);
    pass_.sweep({0, 1, 1, hits().end()});
    begin(watch, Stage::narrow);
    output.hits = pass_.hits().data;
    pass_.narrow(hits());
    begin(watch, Stage::output);
    if (all) write_answer(geometry_, stream_, hits(), output, pass_.counters, earliest ? nullptr : told);
    if (earliest) find_earliest(geometry_, stream_, hits(), slot().earliest, pass_.counters, told);
    enqueue_end(watch, all || earliest);
}

// Whether the pass was complete. If not, the plan is another one. Where nothing but a hit is asked for and there is
// one, lists may be short: each hit is a proof of its own.
bool FeatureFinder::accept() {
    Counters& counters = *slot().counters;
    input().throw_error(counters);
    const bool any = query().extent == Extent::any, proven = any && counters.hits > 0;
    const bool complete = accepts(counters, !any);
    if (!complete && !proven) return false;
    if (complete && !proven && counters.beyond > 0) {
        if (lists_of_ != current()) return false;  // a later pass has written there
        const std::vector<RankedHit> found = decide_beyond(static_cast<std::size_t>(counters.beyond));
        const unsigned long long before = counters.hits;
        counters.hits += found.size();
        if (!any && !found.empty()) {
            if (!pass_.plan.accepts_hits(counters.hits)) return false;
            write_again(found, before);
        }
    }
    count(counters);
    if (complete) accepted();
    read_answer();
    return true;
}

// The answer once more, with what the host has found.
void FeatureFinder::write_again(const std::vector<RankedHit>& found, unsigned long long before) {
    Block block(meter_);
    RankedHit* device = nullptr;
    lay_out(block, [&](Cutter& c) { device = c.take<RankedHit>(found.size()); });
    copy_now(stream_, device, found.data(), found.size(), cudaMemcpyHostToDevice);
    Clearing clearing;
    slot().output.clear(clearing);
    cuda::clear(clearing, slot().earliest);
    clearing.add(&pass_.counters->parts, sizeof pass_.counters->parts);
    clearing.launch(geometry_, stream_);
    append_hits(geometry_, stream_, device, found.size(), before, hits());
    rank_hits(geometry_, stream_, hits());
    if (query().extent == Extent::all) write_answer(geometry_, stream_, hits(), slot().output, pass_.counters, nullptr);
    if (query().motion) find_earliest(geometry_, stream_, hits(), slot().earliest, pass_.counters, nullptr);
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
            const FeatureDecision decision = decide(cases[i], query(), counts);
            if (!decision.hit) continue;
            const std::uint32_t base = firsts().base[static_cast<std::size_t>(cases[i].kind)];
            found.push_back({base + static_cast<std::uint32_t>(cases[i].pair.a), cases[i].pair.b, 0, decision.flag,
                             decision.value});
            if (query().extent == Extent::any) return found;
        }
    }
    return found;
}

void FeatureFinder::read_answer() {
    FeatureSlot& slot = this->slot();
    slot.any = slot.counters->hits > 0;
    slot.first = {};
    slot.ends = {};
    if (query().extent == Extent::any) return;
    if (query().motion && slot.any) read_earliest();
    if (query().extent != Extent::all) return;
    for (std::size_t k = 0; k <= feature_kinds; ++k)
        CRUMPLE_CUDA(cudaMemcpyAsync(&slot.ends[k], slot.output.offsets + firsts().base[k], sizeof slot.ends[k],
                                     cudaMemcpyDeviceToHost, stream_));
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
}

void FeatureFinder::read_earliest() {
    Earliest first{};
    copy_now(stream_, &first, slot().earliest, 1, cudaMemcpyDeviceToHost);
    const auto joint = static_cast<std::uint32_t>(first.pair >> 32);
    std::size_t kind = 0;
    while (joint >= firsts().base[kind + 1]) ++kind;
    slot().first = {true,
                    static_cast<FeatureKind>(kind),
                    {static_cast<std::int32_t>(joint - firsts().base[kind]), static_cast<std::int32_t>(first.pair)},
                    {},
                    std::bit_cast<double>(first.value),
                    first.flag != 0};
}

void FeatureFinder::copy_to(FeatureAnswer& answer) {
    FeatureSlot& slot = this->slot();
    if (slot.on_host) {
        answer = std::move(slot.host);
        slot.host = FeatureAnswer(&meter_);
        slot.lost = true;
    } else {
        for (std::size_t k = 0; k < feature_kinds; ++k) {
            const auto begin = static_cast<std::size_t>(slot.ends[k]);
            const auto count = static_cast<std::size_t>(slot.ends[k + 1]) - begin;
            FeatureRows& rows = answer.rows[k];
            const auto copy = [&](auto& array, const auto* device) {
                copy_now(stream_, array.resize_discard(count), device + begin, count, cudaMemcpyDeviceToHost);
            };
            copy(rows.pairs, slot.output.pairs);
            copy(rows.value, slot.output.value);
            copy(rows.flag, slot.output.flag);
        }
    }
    answer.any = slot.any;
    answer.first = slot.first;
    answer.statistics = slot.statistics;
}

// Lists that were found in chunks, where they would be if they had been found at once.
void FeatureFinder::upload() {
    FeatureSlot& slot = this->slot();
    slot.ends = {};
    for (std::size_t k = 0; k < feature_kinds; ++k) slot.ends[k + 1] = slot.ends[k] + slot.host.rows[k].pairs.size();
    const auto all = static_cast<std::size_t>(slot.ends[feature_kinds]);
    FeatureOutput& output = slot.output;
    lay_out(slot.room, [&](Cutter& c) {
        output.pairs = c.take<Pair>(all);
        output.value = c.take<double>(all);
        output.flag = c.take<std::uint8_t>(all);
    });
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const FeatureRows& rows = slot.host.rows[k];
        const auto copy = [&](auto* device, const auto& array) {
            copy_now(stream_, device + slot.ends[k], array.data(), array.size(), cudaMemcpyHostToDevice);
        };
        copy(output.pairs, rows.pairs);
        copy(output.value, rows.value);
        copy(output.flag, rows.flag);
    }
    slot.host = FeatureAnswer(&meter_);
    slot.on_host = false;
}

DeviceAnswer FeatureFinder::show() {
    if (slot().on_host) upload();
    const FeatureSlot& slot = this->slot();
    DeviceAnswer shown;
    shown.any = slot.any;
    shown.first = slot.first;
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const unsigned long long begin = slot.ends[k];
        const auto count = static_cast<std::int64_t>(slot.ends[k + 1] - begin);
        if (count > 0)
            shown.rows[k] = {count, slot.output.pairs + begin, slot.output.value + begin, slot.output.flag + begin};
    }
    shown.rows_needed = shown.count = static_cast<std::int64_t>(slot.ends[feature_kinds]);
    shown.edges = features_.known().edges;
    shown.edge_count = features_.known().edge_count;
    shown.statistics = slot.statistics;
    return shown;
}

void FeatureFinder::find_in_chunks(Lists lists) {
    planned_for_ = {};
    clear(slot().host);
    slot().any = false;
    slot().first = {};
    constexpr std::size_t of_test = 2 * sizeof(FeatureTest) + sizeof(OpenTest) + sizeof(RankedHit);
    pass_.plan.choose_feature_chunks(pass_.scene.triangle_count(), pass_.all_kinds, options_,
                                     lists == Lists::roomy ? bytes_for_lists(meter_) : 0, of_test);
    Array<RankedHit> found(&meter_);
    const auto cut = [&](Cutter& c) { slot().output.cut(c, firsts(), 0); };
    const auto make_ready = [&] {
        slot().features.enqueue(geometry_, stream_, pass_.scene, pass_.box, pass_.counters);
    };
    over_chunks(cut, make_ready, [&] { return take_slice(found); });
    drop_lists();
    write_sorted(found);
}

// False once nothing more is wanted.
bool FeatureFinder::take_slice(Array<RankedHit>& found) {
    const bool any = query().extent == Extent::any;
    pass_.narrow(hits());
    const Counters counters = read_counters();
    count(counters);
    slot().any = slot().any || counters.hits > 0;
    if (any && slot().any) return false;
    const auto listed = static_cast<std::size_t>(counters.hits), before = found.size();
    if (!any) {
        found.resize(before + listed);
        copy_now(stream_, found.data() + before, pass_.hits().data, listed, cudaMemcpyDeviceToHost);
    }
    if (counters.beyond == 0) return true;
    for (const RankedHit& hit : decide_beyond(static_cast<std::size_t>(counters.beyond))) {
        slot().any = true;
        if (!any) found.push_back(hit);
    }
    return !(any && slot().any);
}

void FeatureFinder::write_sorted(Array<RankedHit>& found) {
    const auto pair = [](const RankedHit& hit) { return std::pair(hit.first, hit.second); };
    if (query().extent == Extent::any) return;
    std::sort(found.begin(), found.end(), [&](const RankedHit& a, const RankedHit& b) { return pair(a) < pair(b); });
    const RankedHit* hit = found.begin();
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const std::uint32_t base = firsts().base[k];
        FeatureRows& rows = slot().host.rows[k];
        for (; hit != found.end() && hit->first < firsts().base[k + 1]; ++hit) {
            const Pair features{static_cast<std::int32_t>(hit->first - base), hit->second};
            const FirstImpact impact{true, static_cast<FeatureKind>(k), features, {}, hit->value, hit->flag != 0};
            if (query().motion && (!slot().first.found || impact.toi < slot().first.toi)) slot().first = impact;
            if (query().extent != Extent::all) continue;
            rows.pairs.push_back(features);
            rows.value.push_back(hit->value);
            rows.flag.push_back(static_cast<std::uint8_t>(hit->flag));
        }
    }
}

}  // namespace crumple::cuda
