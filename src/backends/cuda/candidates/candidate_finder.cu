#include "backends/cuda/candidates/candidate_finder.h"

namespace crumple::cuda {

CandidateFinder::CandidateFinder(BackendState& state, FeaturesOnDevice& features)
    : RowFinder(state, pass_, features),
      pass_(geometry_, stream_, options_),
      own_{CandidateSlot(meter_), CandidateSlot(meter_)} {}

void CandidateFinder::release() {
    RowFinder::release();
    for (CandidateSlot& slot : own_) slot.values.release();
}

void CandidateFinder::upload_request(const FeatureRequest& request, bool, Growth growth) {
    CandidateSlot& own = this->own();
    const PreparedScene& scene = input().scene();
    own.firsts = firsts_of(request);
    place_arrays(
        own.values,
        [&](ArenaLayout& c) {
            own.widening = c.take<Inflation>(1);
            own.normaliser = c.take<Normaliser>(1);
        },
        growth);
    own.asked = {};
    for (std::size_t k = 0; k < candidate_kinds; ++k) own.asked.wanted |= unsigned{request.kinds[k]} << k;
    own.asked.inflation = request.distance;
    own.asked.features = features_.bring(request.features, scene.vertex_count(), growth);
    own.asked.normaliser = own.normaliser;
    own.asked.points = {scene, is_aligned(scene)};
}

void CandidateFinder::bind() {
    Finder::bind();
    pass_.asked = own().asked;
    pass_.primitives = widened_primitives(scene(), own().widening, true);
}

void CandidateFinder::choose_plan(Plan& plan) const { plan.choose_candidates(scene().triangle_count(), options_); }

void CandidateFinder::choose_chunks(Plan& plan, std::int64_t bytes) const {
    plan.choose_candidate_chunks(scene().triangle_count(), options_, bytes, sizeof(RankedCandidate));
}

void CandidateFinder::cut_rows(ArenaLayout& c) { own().output.cut(c, own().firsts, pass_.plan.hits); }

void CandidateFinder::clear_rows(BatchedClear& batch) const { own().output.clear(batch); }

void CandidateFinder::make_ready() {
    make_normaliser(stream_, pass_.box, pass_.asked.inflation, own().widening, own().normaliser);
}

CandidateHits CandidateFinder::hits() const { return {pass_.hits(), own().output.offsets, own().firsts}; }

void CandidateFinder::narrow() {
    pass_.narrow(hits());
    pass_.search_within(hits());
}

bool CandidateFinder::write_rows(Counters* host_counters) {
    write_feature_rows(geometry_, stream_, hits(), own().output, pass_.counters, host_counters);
    return true;
}

void CandidateFinder::find_in_chunks() {
    begin_on_host();
    place_arrays(slot().rows, [&](ArenaLayout& c) { own().output.cut(c, own().firsts, 0); });
    Array<RankedCandidate> found(&meter_);
    bool first = true;
    over_chunks([&] {
        pass_.narrow(hits());
        download_hits(found);
        if (first) {  // finds pairs within single triangles once; Plan::hits suffices for all of them
            pass_.clear_counters();
            pass_.search_within(hits());
            download_hits(found);
        }
        first = false;
        return true;
    });
    drop_lists();
    for_each_sorted(found, own().firsts, [&](CandidateKind kind, const Pair& pair, const RankedCandidate&) {
        this->found().host.rows[kind].pairs.push_back(pair);
    });
    this->found().any = !found.empty();
}

void CandidateFinder::download_hits(Array<RankedCandidate>& found) {
    const Counters counters = read_counters();
    count(counters, pass_.plan);
    download(stream_, pass_.hits(), static_cast<std::size_t>(counters.hits), found);
}

}  // namespace crumple::cuda
