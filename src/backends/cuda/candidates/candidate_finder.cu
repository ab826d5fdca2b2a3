#include "backends/cuda/candidates/candidate_finder.h"

#include <limits>

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

void CandidateFinder::release() {
    Finder::release();
    for (CandidateSlot& slot : slots_) {
        slot.values.release();
        slot.host = CandidateAnswer(&meter_);
    }
    planned_for_ = -1;
}

void CandidateFinder::bring(std::size_t to, const PreparedScene& scene, const CandidateRequest& query) {
    take_slot(to);
    input().bring(scene);
    input().want(query.rule);
    features_.bring(query.features, scene.vertex_count());
    adopt(query, Room::grows);
}

void CandidateFinder::view(std::size_t to, const Shape& shape, const CandidateRequest& query, Room room) {
    take_slot(to);
    features_.bring(query.features, shape.vertices.rows, room);
    input().view(shape, features_.known(), room);
    input().want(query.rule, room);
    adopt(query, room);
}

void CandidateFinder::adopt(const CandidateRequest& query, Room room) {
    CandidateSlot& slot = this->slot();
    const PreparedScene& scene = input().scene();
    slot.revision = query.features.revision();
    slot.frugal = query.frugal;
    slot.firsts = firsts_of(query);
    lay_out(
        slot.values,
        [&](Cutter& c) {
            slot.widening = c.take<Inflation>(1);
            slot.normaliser = c.take<Normaliser>(1);
        },
        room);
    AskedOfCandidates asked;
    for (std::size_t k = 0; k < candidate_kinds; ++k) asked.wanted |= unsigned{query.wanted[k]} << k;
    asked.inflation = query.inflation;
    asked.features = features_.bring(query.features, scene.vertex_count(), room);
    asked.normaliser = slot.normaliser;
    asked.points = {scene, is_aligned(scene)};
    slot.asked = asked;
    look();
}

void CandidateFinder::look() {
    Finder::look();
    pass_.asked = slot().asked;
    pass_.primitives = primitives(pass_.scene, slot().widening, true);
}

void CandidateFinder::plan() {
    const std::int64_t n = pass_.scene.triangle_count();
    if (planned_for_ != n) pass_.plan.choose_candidates(n, options_);
    planned_for_ = n;
}

void CandidateFinder::cut_answer(Cutter& c) { slot().output.cut(c, slot().firsts, pass_.plan.hits); }

CandidateHits CandidateFinder::hits() const {
    return {pass_.hits(), slot().output.offsets, slot().output.by_tile, slot().firsts};
}

void CandidateFinder::make_ready() {
    make_normaliser(stream_, pass_.box, pass_.asked.inflation, slot().widening, slot().normaliser);
}

void CandidateFinder::enqueue(StageEvents* watch) {
    Clearing clearing;
    slot().output.clear(clearing);
    enqueue_until_sorted(clearing, watch, [&] { make_ready(); });
    begin(watch, Stage::sweep);
    pass_.sweep({});
    begin(watch, Stage::narrow);
    pass_.narrow(hits());
    pass_.search_within(hits());
    begin(watch, Stage::output);
    write_answer(geometry_, stream_, hits(), slot().output, pass_.counters, slot().counters.get());
    enqueue_end(watch, true);
}

bool CandidateFinder::accept() {
    CandidateSlot& slot = this->slot();
    input().throw_error(*slot.counters);
    if (!accepts(*slot.counters, true)) return false;
    count(*slot.counters);
    accepted();
    for (std::size_t k = 0; k <= candidate_kinds; ++k)
        CRUMPLE_CUDA(cudaMemcpyAsync(&slot.ends[k], slot.output.offsets + slot.firsts.base[k], sizeof slot.ends[k],
                                     cudaMemcpyDeviceToHost, stream_));
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
    return true;
}

void CandidateFinder::copy_to(CandidateAnswer& answer) {
    CandidateSlot& slot = this->slot();
    if (slot.on_host) {
        answer = std::move(slot.host);
        slot.host = CandidateAnswer(&meter_);
        slot.lost = true;
    } else {
        for (std::size_t k = 0; k < candidate_kinds; ++k) {
            const auto count = static_cast<std::size_t>(slot.ends[k + 1] - slot.ends[k]);
            copy_now(stream_, answer.pairs[k].resize_discard(count), slot.output.pairs + slot.ends[k], count,
                     cudaMemcpyDeviceToHost);
        }
    }
    answer.statistics = slot.statistics;
}

// Lists that were found in chunks, where they would be if they had been found at once.
void CandidateFinder::upload() {
    CandidateSlot& slot = this->slot();
    slot.ends = {};
    for (std::size_t k = 0; k < candidate_kinds; ++k) slot.ends[k + 1] = slot.ends[k] + slot.host.pairs[k].size();
    lay_out(slot.room,
            [&](Cutter& c) { slot.output.pairs = c.take<Pair>(static_cast<std::size_t>(slot.ends[candidate_kinds])); });
    for (std::size_t k = 0; k < candidate_kinds; ++k)
        copy_now(stream_, slot.output.pairs + slot.ends[k], slot.host.pairs[k].data(), slot.host.pairs[k].size(),
                 cudaMemcpyHostToDevice);
    slot.host = CandidateAnswer(&meter_);
    slot.on_host = false;
}

DeviceAnswer CandidateFinder::show() {
    if (slot().on_host) upload();
    const CandidateSlot& slot = this->slot();
    DeviceAnswer shown;
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        const auto count = static_cast<std::int64_t>(slot.ends[k + 1] - slot.ends[k]);
        if (count > 0) shown.rows[k] = {count, slot.output.pairs + slot.ends[k], nullptr, nullptr};
    }
    shown.rows_needed = shown.count = static_cast<std::int64_t>(slot.ends[candidate_kinds]);
    shown.any = shown.count > 0;
    shown.edges = features_.known().edges;
    shown.edge_count = features_.known().edge_count;
    shown.statistics = slot.statistics;
    return shown;
}

void CandidateFinder::find_in_chunks(Lists lists) {
    planned_for_ = -1;
    clear(slot().host);
    pass_.plan.choose_candidate_chunks(pass_.scene.triangle_count(), options_,
                                       lists == Lists::roomy ? bytes_for_lists(meter_) : 0, sizeof(RankedCandidate));
    Array<RankedCandidate> found(&meter_);
    bool first = true;
    over_chunks([&](Cutter& c) { slot().output.cut(c, slot().firsts, 0); }, [&] { make_ready(); },
                [&] {
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
    count(counters);
    const auto listed = static_cast<std::size_t>(counters.hits), before = found.size();
    found.resize(before + listed);
    copy_now(stream_, found.data() + before, pass_.hits().data, listed, cudaMemcpyDeviceToHost);
}

void CandidateFinder::write_sorted(Array<RankedCandidate>& found) {
    const auto pair = [](const RankedCandidate& hit) { return std::pair(hit.first, hit.second); };
    std::sort(found.begin(), found.end(), [&](const auto& a, const auto& b) { return pair(a) < pair(b); });
    const RankedCandidate* hit = found.begin();
    for (std::size_t k = 0; k < candidate_kinds; ++k)
        for (; hit != found.end() && hit->first < slot().firsts.base[k + 1]; ++hit)
            slot().host.pairs[k].push_back(
                {static_cast<std::int32_t>(hit->first - slot().firsts.base[k]), hit->second});
}

}  // namespace crumple::cuda
