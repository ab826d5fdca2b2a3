#include "engine/cuda/candidate_finder.h"

#include <limits>

#include "crumple/error.h"

namespace crumple::cuda {
namespace {

FirstOfCandidates firsts_of(const CandidateQuery& query) {
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
    values_.release();
    laid_out_.reset();
    planned_for_ = -1;
}

void CandidateFinder::find(const Scene& scene, const CandidateQuery& query, CandidateAnswer& answer) {
    clear(answer);
    answer.statistics.backend = "cuda";
    if (scene.triangle_count() == 0) return;  // lists have a least size, which no limit need hold for nothing
    adopt(scene, query);
    Finder::find(
        query.frugal, [&] { find_at_once(answer); }, [&](Lists lists) { find_in_chunks(answer, lists); });
    answer.statistics = statistics_;
}

void CandidateFinder::adopt(const Scene& scene, const CandidateQuery& query) {
    bring(scene, query.rule);
    firsts_ = firsts_of(query);
    lay_out(values_, [&](Cutter& c) {
        widening_ = c.take<Inflation>(1);
        normaliser_ = c.take<Normaliser>(1);
    });
    AskedOfCandidates asked;
    for (std::size_t k = 0; k < candidate_kinds; ++k) asked.wanted |= unsigned{query.wanted[k]} << k;
    asked.inflation = query.inflation;
    asked.features = features_.bring(query.features, scene.vertex_count());
    asked.normaliser = normaliser_;
    asked.points = {pass_.scene, is_aligned(pass_.scene)};
    pass_.asked = asked;
    pass_.primitives = primitives(scene, widening_, true);
}

void CandidateFinder::lay_out_lists() {
    const Layout wanted{pass_.scene.vertex_count(),
                        pass_.scene.triangle_count(),
                        pass_.scene.float32,
                        pass_.scene.moving,
                        pass_.plan,
                        firsts_};
    if (laid_out_ == wanted) return;
    laid_out_.reset();
    lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
    lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
    lay_out(answer_, [&](Cutter& c) { output_.cut(c, firsts_, pass_.plan.hits); });
    laid_out_ = wanted;
}

CandidateHits CandidateFinder::hits() const { return {pass_.hits(), output_.offsets, output_.by_tile, firsts_}; }

void CandidateFinder::make_ready() {
    make_normaliser(stream_, pass_.box, pass_.asked.inflation, widening_, normaliser_);
}

void CandidateFinder::find_at_once(CandidateAnswer& answer) {
    const std::int64_t n = pass_.scene.triangle_count();
    if (planned_for_ != n) pass_.plan.choose_candidates(n, options_);
    planned_for_ = n;
    for (bool complete = false; !complete;) {
        cancellation_.check();
        lay_out_lists();
        enqueue();
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
        input_.throw_error(*counters_);
        complete = pass_.plan.accepts(*counters_, n, options_);
    }
    count(*counters_);
    accepted();
    watch_.read(statistics_);
    copy_to(answer);
}

void CandidateFinder::enqueue() {
    Clearing clearing;
    output_.clear(clearing);
    enqueue_until_sorted(clearing, [&] { make_ready(); });
    watch_.begin(Stage::sweep, stream_);
    pass_.sweep({});
    watch_.begin(Stage::narrow, stream_);
    pass_.narrow(hits());
    pass_.search_within(hits());
    watch_.begin(Stage::output, stream_);
    write_answer(geometry_, stream_, hits(), output_, pass_.counters);
    enqueue_end();
}

void CandidateFinder::copy_to(CandidateAnswer& answer) {
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        unsigned long long begin = 0, end = 0;
        copy_now(stream_, &begin, output_.offsets + firsts_.base[k], 1, cudaMemcpyDeviceToHost);
        copy_now(stream_, &end, output_.offsets + firsts_.base[k + 1], 1, cudaMemcpyDeviceToHost);
        const auto count = static_cast<std::size_t>(end - begin);
        copy_now(stream_, answer.pairs[k].resize_discard(count), output_.pairs + begin, count, cudaMemcpyDeviceToHost);
    }
}

void CandidateFinder::find_in_chunks(CandidateAnswer& answer, Lists lists) {
    drop_lists();
    laid_out_.reset();
    planned_for_ = -1;
    clear(answer);
    statistics_ = {};
    pass_.plan.choose_candidate_chunks(pass_.scene.triangle_count(), options_,
                                       lists == Lists::roomy ? bytes_for_lists(meter_) : 0, sizeof(RankedCandidate));
    Array<RankedCandidate> found(&meter_);
    bool first = true;
    over_chunks([&](Cutter& c) { output_.cut(c, firsts_, 0); }, [&] { make_ready(); },
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
    write_sorted(found, answer);
}

void CandidateFinder::take_hits(Array<RankedCandidate>& found) {
    const Counters counters = read_counters();
    count(counters);
    const auto listed = static_cast<std::size_t>(counters.hits), before = found.size();
    found.resize(before + listed);
    copy_now(stream_, found.data() + before, pass_.hits().data, listed, cudaMemcpyDeviceToHost);
}

void CandidateFinder::write_sorted(Array<RankedCandidate>& found, CandidateAnswer& answer) const {
    const auto pair = [](const RankedCandidate& hit) { return std::pair(hit.first, hit.second); };
    std::sort(found.begin(), found.end(), [&](const auto& a, const auto& b) { return pair(a) < pair(b); });
    const RankedCandidate* hit = found.begin();
    for (std::size_t k = 0; k < candidate_kinds; ++k)
        for (; hit != found.end() && hit->first < firsts_.base[k + 1]; ++hit)
            answer.pairs[k].push_back({static_cast<std::int32_t>(hit->first - firsts_.base[k]), hit->second});
}

}  // namespace crumple::cuda
