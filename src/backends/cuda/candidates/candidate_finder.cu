#include "backends/cuda/candidates/candidate_finder.h"

#include "crumple/error.h"

namespace crumple::cuda {
namespace {

FirstOfCandidates firsts_of(const CandidateRequest& query) {
    FirstOfCandidates firsts;
    std::int64_t base = 0;
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        const auto kind = static_cast<CandidateKind>(k);
        if (query.wants(kind)) base += count_of(query.features, types_of(kind).first);
        check_joint_number(base);
        firsts.base[k + 1] = static_cast<std::uint32_t>(base);
    }
    return firsts;
}

}  // namespace

CandidateFinder::CandidateFinder(BackendState& state, FeaturesOnDevice& features)
    : Finder(state, pass_),
      features_(features),
      pass_(geometry_, stream_, options_),
      own_{CandidateSlot(meter_), CandidateSlot(meter_)} {}

void CandidateFinder::release() {
    Finder::release();
    for (CandidateSlot& slot : own_) {
        slot.values.release();
        slot.host = CandidateAnswer(&meter_);
    }
}

void CandidateFinder::bring(std::size_t to, const PreparedScene& scene, const CandidateRequest& query) {
    take_slot(to, [&] {
        input().bring(scene);
        input().want(query.rule);
        features_.bring(query.features, scene.vertex_count());
        adopt(query, Room::grows);
    });
    bind();
}

void CandidateFinder::view(std::size_t to, const Shape& shape, const CandidateRequest& query, Room room) {
    take_slot(to, [&] {
        features_.bring(query.features, shape.vertices.rows, room);
        input().view(shape, features_.known(), room);
        input().want(query.rule, room);
        adopt(query, room);
    });
    bind();
}

void CandidateFinder::adopt(const CandidateRequest& query, Room room) {
    CandidateSlot& own = this->own();
    const PreparedScene& scene = input().scene();
    slot().revision = query.features.revision();
    slot().low_memory = query.frugal;
    own.firsts = firsts_of(query);
    lay_out(
        own.values,
        [&](Cutter& c) {
            own.widening = c.take<Inflation>(1);
            own.normaliser = c.take<Normaliser>(1);
        },
        room);
    own.asked = {};
    for (std::size_t k = 0; k < candidate_kinds; ++k) own.asked.wanted |= unsigned{query.wanted[k]} << k;
    own.asked.inflation = query.inflation;
    own.asked.features = features_.bring(query.features, scene.vertex_count(), room);
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

void CandidateFinder::cut_rows(Cutter& c) { own().output.cut(c, own().firsts, pass_.plan.hits); }

void CandidateFinder::clear_rows(Clearing& clearing) const { own().output.clear(clearing); }

void CandidateFinder::make_ready() {
    make_normaliser(stream_, pass_.box, pass_.asked.inflation, own().widening, own().normaliser);
}

CandidateHits CandidateFinder::hits() const {
    return {pass_.hits(), own().output.offsets, own().output.by_tile, own().firsts};
}

void CandidateFinder::narrow() {
    pass_.narrow(hits());
    pass_.search_within(hits());
}

bool CandidateFinder::write_rows(Counters* host_counters) {
    write_answer(geometry_, stream_, hits(), own().output, pass_.counters, host_counters);
    return true;
}

void CandidateFinder::count_tests(const Counters& c, Statistics& s) const { count_feature_tests(c, s); }

void CandidateFinder::read_rows(unsigned long long) { own().ends.read(stream_, own().output); }

void CandidateFinder::copy_to(CandidateAnswer& answer) {
    CandidateSlot& own = this->own();
    if (slot().on_host) {
        answer = std::move(own.host);
        own.host = CandidateAnswer(&meter_);
        slot().lost = true;
    } else {
        for (std::size_t k = 0; k < candidate_kinds; ++k)
            copy_now(stream_, answer.pairs[k].resize_discard(own.ends.count(k)), own.output.pairs + own.ends.begin(k),
                     own.ends.count(k), cudaMemcpyDeviceToHost);
    }
    answer.statistics = statistics();
}

// Lists that were found in chunks, where they would be if they had been found at once.
void CandidateFinder::upload() {
    CandidateSlot& own = this->own();
    own.ends = {};
    for (std::size_t k = 0; k < candidate_kinds; ++k) own.ends.append(k, own.host.pairs[k].size());
    lay_out(slot().rows, [&](Cutter& c) { own.output.pairs = c.take<Pair>(own.ends.all()); });
    for (std::size_t k = 0; k < candidate_kinds; ++k)
        copy_now(stream_, own.output.pairs + own.ends.begin(k), own.host.pairs[k].data(), own.host.pairs[k].size(),
                 cudaMemcpyHostToDevice);
    own.host = CandidateAnswer(&meter_);
    slot().on_host = false;
}

DeviceAnswer CandidateFinder::show() {
    if (slot().on_host) upload();
    const CandidateSlot& own = this->own();
    DeviceAnswer shown = shown_answer(features_.known(), own.ends.all(), statistics());
    shown.any = shown.count > 0;
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        const auto count = static_cast<std::int64_t>(own.ends.count(k));
        if (count > 0) shown.rows[k] = {count, own.output.pairs + own.ends.begin(k), nullptr, nullptr};
    }
    return shown;
}

void CandidateFinder::find_in_chunks() {
    slot().on_host = true;
    clear(own().host);
    lay_out(slot().rows, [&](Cutter& c) { own().output.cut(c, own().firsts, 0); });
    Array<RankedCandidate> found(&meter_);
    bool first = true;
    over_chunks([&] {
        pass_.narrow(hits());
        take_hits(found);
        if (first) {  // of each triangle by itself once, in a list that holds them
            pass_.clear_counters();
            pass_.search_within(hits());
            take_hits(found);
        }
        first = false;
        return true;
    });
    drop_lists();
    write_sorted(found);
}

void CandidateFinder::take_hits(Array<RankedCandidate>& found) {
    const Counters counters = read_counters();
    count(counters, pass_.plan);
    download(stream_, pass_.hits(), static_cast<std::size_t>(counters.hits), found);
}

void CandidateFinder::write_sorted(Array<RankedCandidate>& found) {
    for_each_sorted(found, own().firsts, [&](std::size_t kind, const Pair& pair, const RankedCandidate&) {
        own().host.pairs[kind].push_back(pair);
    });
}

}  // namespace crumple::cuda
