#include "backends/cuda/features/feature_finder.h"

#include <algorithm>
#include <bit>

#include "backends/decide_features.h"

namespace crumple::cuda {
namespace {

constexpr std::size_t batch = 4096;  // tests that are copied to the host at once

}  // namespace

FeatureFinder::FeatureFinder(BackendState& state, FeaturesOnDevice& features)
    : RowFinder(state, pass_, features),
      pass_(geometry_, stream_, options_),
      own_{FeatureSlot(stream_, meter_), FeatureSlot(stream_, meter_)} {}

void FeatureFinder::release() {
    RowFinder::release();
    for (FeatureSlot& slot : own_) slot.features.release();
}

void FeatureFinder::upload_request(const FeatureRequest& request, bool viewed, Growth growth) {
    if (viewed)
        own().features.view(input().scene(), request, features_, growth);
    else
        own().features.bring(input().scene(), request, features_);
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
    constexpr std::size_t of_test = 2 * sizeof(FeatureTest) + sizeof(UnresolvedTest) + sizeof(RankedHit);
    plan.choose_feature_chunks(scene().triangle_count(), all_kinds(), options_, bytes, of_test);
}

void FeatureFinder::cut_rows(ArenaLayout& c) {
    own().earliest = c.take<Earliest>(1);
    own().output.cut(c, firsts(), is_all_output() ? pass_.plan.hits : 0);
}

void FeatureFinder::clear_rows(BatchedClear& batch) const {
    own().output.clear(batch);
    cuda::clear(batch, own().earliest);
}

void FeatureFinder::make_ready() { own().features.enqueue(geometry_, stream_, scene(), pass_.box, pass_.counters); }

FeatureHits FeatureFinder::hits() const {
    const FeatureOutput& output = own().output;
    return {is_any_output(), pass_.hits(), output.offsets, firsts()};
}

void FeatureFinder::narrow() {
    own().output.hits = pass_.hits().data;
    pass_.narrow(hits());
}

bool FeatureFinder::write_rows(Counters* host_counters) {
    if (is_all_output())
        write_feature_rows(geometry_, stream_, hits(), own().output, pass_.counters,
                           is_first_output() ? nullptr : host_counters);
    if (is_first_output()) find_earliest(geometry_, stream_, hits(), own().earliest, pass_.counters, host_counters);
    return is_all_output() || is_first_output();
}

// Appends the hits that the host has decided (decided_) to the list on the device, and ranks all hits anew.
void FeatureFinder::append_decided(std::size_t count, unsigned long long before) {
    Block block(meter_);
    RankedHit* device = nullptr;
    place_arrays(block, [&](ArenaLayout& c) { device = c.take<RankedHit>(count); });
    copy_now(stream_, device, decided_.data(), count, cudaMemcpyHostToDevice);
    append_hits(geometry_, stream_, device, count, before, hits());
    rank_hits(geometry_, stream_, hits());
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));  // before the block is freed
}

// Decides on the host, in rational arithmetic, what the device left open.
std::size_t FeatureFinder::decide_unresolved(std::size_t count) {
    decided_.clear();
    std::vector<FeaturesToDecide> cases(std::min(count, batch));
    Block block(meter_);
    FeaturesToDecide* device = nullptr;
    place_arrays(block, [&](ArenaLayout& c) { device = c.take<FeaturesToDecide>(cases.size()); });
    fill(stream_, device, 0, cases.size() * sizeof(FeaturesToDecide));  // padding is copied, too
    for (std::size_t begin = 0; begin < count; begin += batch) {
        const std::size_t some = std::min(batch, count - begin);
        gather_cases(geometry_, stream_, pass_.scene, pass_.asked, pass_.beyond() + begin, some, device);
        copy_now(stream_, cases.data(), device, some, cudaMemcpyDeviceToHost);
        for (std::size_t i = 0; i < some; ++i) {
            cancellation_.check();
            FeatureCounts counts;
            const FeatureDecision decision = decide(cases[i], request(), counts);
            if (!decision.hit) continue;
            decided_.push_back(
                {firsts().joint(cases[i].kind, cases[i].pair.a), cases[i].pair.b, 0, decision.flag, decision.value});
            if (is_any_output()) return decided_.size();
        }
    }
    return decided_.size();
}

void FeatureFinder::read_rows(unsigned long long total) {
    RowFinder::read_rows(total);
    if (is_first_output() && total > 0) read_earliest();
}

void FeatureFinder::read_earliest() {
    Earliest first{};
    copy_now(stream_, &first, own().earliest, 1, cudaMemcpyDeviceToHost);
    const auto joint = static_cast<std::uint32_t>(first.pair >> 32);
    found().first = {
        true, firsts().kind_of_impact(joint),     firsts().pair(joint, static_cast<std::int32_t>(first.pair)),
        {},   std::bit_cast<double>(first.value), first.flag != 0};
}

void FeatureFinder::find_in_chunks() {
    begin_on_host();
    place_arrays(slot().rows, [&](ArenaLayout& c) { own().output.cut(c, firsts(), 0); });
    Array<RankedHit> found(&meter_);
    over_chunks([&] { return download_slice(found); });
    drop_lists();
    write_sorted(found);
}

// Runs `narrow` on a slice, and appends its hits to `found`; for a flag, only notes whether there is one. Returns false
// if the search can end.
bool FeatureFinder::download_slice(Array<RankedHit>& found) {
    narrow();
    const Counters counters = read_counters();
    count(counters, pass_.plan);
    bool& any = this->found().any;
    any = any || counters.hits > 0;
    if (is_any_output() && any) return false;
    if (!is_any_output()) download(stream_, pass_.hits(), static_cast<std::size_t>(counters.hits), found);
    if (counters.beyond == 0) return true;
    any = decide_unresolved(static_cast<std::size_t>(counters.beyond)) > 0 || any;
    if (!is_any_output())
        for (const RankedHit& hit : decided_) found.push_back(hit);
    return !(is_any_output() && any);
}

void FeatureFinder::write_sorted(Array<RankedHit>& found) {
    for_each_sorted(found, firsts(), [&](CandidateKind kind, const Pair& pair, const RankedHit& hit) {
        FirstImpact& first = this->found().first;
        if (request().criterion == Criterion::impact && (!first.found || hit.value < first.toi))
            first = {true, firsts().kind_of_impact(hit.first), pair, {}, hit.value, hit.flag != 0};
        if (!is_all_output()) return;
        this->found().host.rows[kind].push_back({pair, hit.value, static_cast<std::uint8_t>(hit.flag)});
    });
}

}  // namespace crumple::cuda
