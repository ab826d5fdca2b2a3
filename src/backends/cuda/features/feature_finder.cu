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

FeatureFinder::FeatureFinder(BackendState& state, FeaturesOnDevice& features)
    : Finder(state, pass_),
      features_(features),
      pass_(geometry_, stream_, options_),
      own_{FeatureSlot(stream_, meter_), FeatureSlot(stream_, meter_)} {}

void FeatureFinder::release() {
    Finder::release();
    for (FeatureSlot& slot : own_) {
        slot.features.release();
        slot.host = FeatureAnswer(&meter_);
    }
}

void FeatureFinder::bring(std::size_t to, const PreparedScene& scene, const FeatureRequest& query) {
    take_slot(to, [&] {
        input().bring(scene);
        input().want(query.rule);
        own().features.bring(scene, query, features_);
    });
    adopt(query);
}

void FeatureFinder::view(std::size_t to, const Shape& shape, const FeatureRequest& query, Room room) {
    take_slot(to, [&] {
        features_.bring(query.features, shape.vertices.rows, room);
        input().view(shape, features_.known(), room);
        input().want(query.rule, room);
        own().features.view(input().scene(), query, features_, room);
    });
    adopt(query);
}

void FeatureFinder::adopt(const FeatureRequest& query) {
    own().ask(query);
    slot().low_memory = query.frugal;
    slot().revision = query.features.revision();
    bind();
}

void FeatureFinder::bind() {
    Finder::bind();
    pass_.asked = own().features.asked();
    pass_.all_kinds = all_kinds();
    pass_.primitives = widened_primitives(scene(), pass_.asked.inflation, false);
}

void FeatureFinder::choose_plan(Plan& plan) const {
    plan.choose_features(scene().triangle_count(), all_kinds(), options_);
}

void FeatureFinder::choose_chunks(Plan& plan, std::int64_t bytes) const {
    constexpr std::size_t of_test = 2 * sizeof(FeatureTest) + sizeof(OpenTest) + sizeof(RankedHit);
    plan.choose_feature_chunks(scene().triangle_count(), all_kinds(), options_, bytes, of_test);
}

void FeatureFinder::cut_rows(Cutter& c) {
    own().earliest = c.take<Earliest>(1);
    own().output.cut(c, firsts(), wants_all() ? pass_.plan.hits : 0);
}

void FeatureFinder::clear_rows(Clearing& clearing) const {
    own().output.clear(clearing);
    cuda::clear(clearing, own().earliest);
}

void FeatureFinder::make_ready() { own().features.enqueue(geometry_, stream_, scene(), pass_.box, pass_.counters); }

FeatureHits FeatureFinder::hits() const {
    const FeatureOutput& output = own().output;
    return {wants_any(), pass_.hits(), output.offsets, output.by_tile, firsts()};
}

void FeatureFinder::narrow() {
    own().output.hits = pass_.hits().data;
    pass_.narrow(hits());
}

bool FeatureFinder::write_rows(Counters* host_counters) {
    if (wants_all())
        write_answer(geometry_, stream_, hits(), own().output, pass_.counters,
                     wants_earliest() ? nullptr : host_counters);
    if (wants_earliest()) find_earliest(geometry_, stream_, hits(), own().earliest, pass_.counters, host_counters);
    return wants_all() || wants_earliest();
}

void FeatureFinder::count_tests(const Counters& c, Statistics& s) const { count_feature_tests(c, s); }

// Their places in the list are ranked anew with all others.
void FeatureFinder::append_decided(std::size_t count, unsigned long long before) {
    Block block(meter_);
    RankedHit* device = nullptr;
    lay_out(block, [&](Cutter& c) { device = c.take<RankedHit>(count); });
    copy_now(stream_, device, decided_.data(), count, cudaMemcpyHostToDevice);
    append_hits(geometry_, stream_, device, count, before, hits());
    rank_hits(geometry_, stream_, hits());
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));  // before the block goes
}

// Decides in rational arithmetic what no filter of the device could.
std::size_t FeatureFinder::decide_beyond(std::size_t count) {
    decided_.clear();
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
            decided_.push_back(
                {firsts().joint(cases[i].kind, cases[i].pair.a), cases[i].pair.b, 0, decision.flag, decision.value});
            if (wants_any()) return decided_.size();
        }
    }
    return decided_.size();
}

void FeatureFinder::read_rows(unsigned long long total) {
    FeatureSlot& slot = own();
    slot.any = total > 0;
    slot.first = {};
    slot.ends = {};
    if (wants_earliest() && slot.any) read_earliest();
    if (wants_all()) slot.ends.read(stream_, slot.output);
}

void FeatureFinder::read_earliest() {
    Earliest first{};
    copy_now(stream_, &first, own().earliest, 1, cudaMemcpyDeviceToHost);
    const auto joint = static_cast<std::uint32_t>(first.pair >> 32);
    std::size_t kind = 0;
    while (joint >= firsts().base[kind + 1]) ++kind;
    own().first = {
        true, static_cast<FeatureKind>(kind),     firsts().pair(joint, static_cast<std::int32_t>(first.pair)),
        {},   std::bit_cast<double>(first.value), first.flag != 0};
}

void FeatureFinder::copy_to(FeatureAnswer& answer) {
    FeatureSlot& own = this->own();
    if (slot().on_host) {
        answer = std::move(own.host);
        own.host = FeatureAnswer(&meter_);
        slot().lost = true;
    } else {
        for (std::size_t k = 0; k < feature_kinds; ++k) {
            FeatureRows& rows = answer.rows[k];
            const auto copy = [&](auto& array, const auto* device) {
                copy_now(stream_, array.resize_discard(own.ends.count(k)), device + own.ends.begin(k),
                         own.ends.count(k), cudaMemcpyDeviceToHost);
            };
            copy(rows.pairs, own.output.pairs);
            copy(rows.value, own.output.value);
            copy(rows.flag, own.output.flag);
        }
    }
    answer.any = own.any;
    answer.first = own.first;
    answer.statistics = statistics();
}

// Lists that were found in chunks, where they would be if they had been found at once.
void FeatureFinder::upload() {
    FeatureSlot& own = this->own();
    own.ends = {};
    for (std::size_t k = 0; k < feature_kinds; ++k) own.ends.append(k, own.host.rows[k].pairs.size());
    FeatureOutput& output = own.output;
    lay_out(slot().rows, [&](Cutter& c) {
        output.pairs = c.take<Pair>(own.ends.all());
        output.value = c.take<double>(own.ends.all());
        output.flag = c.take<std::uint8_t>(own.ends.all());
    });
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const FeatureRows& rows = own.host.rows[k];
        const auto copy = [&](auto* device, const auto& array) {
            copy_now(stream_, device + own.ends.begin(k), array.data(), array.size(), cudaMemcpyHostToDevice);
        };
        copy(output.pairs, rows.pairs);
        copy(output.value, rows.value);
        copy(output.flag, rows.flag);
    }
    own.host = FeatureAnswer(&meter_);
    slot().on_host = false;
}

DeviceAnswer FeatureFinder::show() {
    if (slot().on_host) upload();
    const FeatureSlot& own = this->own();
    DeviceAnswer shown = shown_answer(features_.known(), own.ends.all(), statistics());
    shown.any = own.any;
    shown.first = own.first;
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const std::size_t begin = own.ends.begin(k), count = own.ends.count(k);
        if (count > 0)
            shown.rows[k] = {static_cast<std::int64_t>(count), own.output.pairs + begin, own.output.value + begin,
                             own.output.flag + begin};
    }
    return shown;
}

void FeatureFinder::find_in_chunks() {
    FeatureSlot& own = this->own();
    slot().on_host = true;
    clear(own.host);
    own.any = false;
    own.first = {};
    lay_out(slot().rows, [&](Cutter& c) { own.output.cut(c, firsts(), 0); });
    Array<RankedHit> found(&meter_);
    over_chunks([&] { return take_slice(found); });
    drop_lists();
    write_sorted(found);
}

// False once nothing more is wanted.
bool FeatureFinder::take_slice(Array<RankedHit>& found) {
    narrow();
    const Counters counters = read_counters();
    count(counters, pass_.plan);
    bool& any = own().any;
    any = any || counters.hits > 0;
    if (wants_any() && any) return false;
    if (!wants_any()) download(stream_, pass_.hits(), static_cast<std::size_t>(counters.hits), found);
    if (counters.beyond == 0) return true;
    any = decide_beyond(static_cast<std::size_t>(counters.beyond)) > 0 || any;
    if (!wants_any())
        for (const RankedHit& hit : decided_) found.push_back(hit);
    return !(wants_any() && any);
}

void FeatureFinder::write_sorted(Array<RankedHit>& found) {
    for_each_sorted(found, firsts(), [&](std::size_t kind, const Pair& pair, const RankedHit& hit) {
        const FirstImpact impact{true, static_cast<FeatureKind>(kind), pair, {}, hit.value, hit.flag != 0};
        FirstImpact& first = own().first;
        if (query().motion && (!first.found || impact.toi < first.toi)) first = impact;
        if (!wants_all()) return;
        FeatureRows& rows = own().host.rows[kind];
        rows.pairs.push_back(pair);
        rows.value.push_back(hit.value);
        rows.flag.push_back(static_cast<std::uint8_t>(hit.flag));
    });
}

}  // namespace crumple::cuda
