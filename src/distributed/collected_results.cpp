// The phases search, rows and output of each query on a rank (rank_detector.h).

#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include "distributed/found_features.h"
#include "distributed/found_rows.h"
#include "distributed/rank_detector.h"
#include "results/intersection_output.h"

namespace crumple::distribute {
namespace {

// Key that sorts impacts. Times are not negative, so their bits sort like the times.
std::array<std::int64_t, 5> key_of(const FirstImpact& impact) {
    return {std::bit_cast<std::int64_t>(impact.toi), static_cast<std::int64_t>(impact.kind), impact.pair.a,
            impact.pair.b, !impact.start};
}

}  // namespace

std::int64_t RankDetector::add_up(std::int64_t found, bool cut_short) {
    statistics_.search.pairs = found;
    std::int64_t largest = std::accumulate(work_.begin(), work_.end(), std::int64_t{0});
    reduce({&largest, 1}, Reduction::max);
    work_.push_back(found);
    reduce(work_, Reduction::sum);
    const std::int64_t all = work_.back();
    work_.pop_back();
    const auto sum = static_cast<double>(std::accumulate(work_.begin(), work_.end(), std::int64_t{0}));
    statistics_.largest_work = 1e-6 * static_cast<double>(largest);
    statistics_.mean_work = 1e-6 * sum / transport_.size();
    if (cut_short) return all;
    // The expected work of the next call is a running mean, because measured times vary from call to call.
    if (expected_work_.size() != work_.size()) expected_work_ = work_;
    for (std::size_t k = 0; k < work_.size(); ++k) expected_work_[k] = (expected_work_[k] + work_[k]) / 2;
    return all;
}

const DistributedIntersections& RankDetector::find(const LocalMesh& local, const IntersectionQuery& query,
                                                   std::stop_token stop) {
    result_ = {};
    const RankOutput output = output_of(query);
    run(
        local, nullptr, [&] { return request_of_ranks(query, output); }, [] {}, std::move(stop),
        [&] { search_rows(query, output); });
    result_.statistics = statistics_;
    return result_;
}

void RankDetector::search_rows(const IntersectionQuery& query, RankOutput wants) {
    FoundRows rows(transport_.size());
    std::int64_t found = 0;
    const auto each = [&](AssembledPart& part) {
        if (wants == RankOutput::any) {
            found = engine_->any(part.part(), query, part.memory(), stop_);
            return;
        }
        const Intersections& in_part = engine_->find(part.part(), query, part.memory(), stop_);
        found += static_cast<std::int64_t>(in_part.pairs.size());
        if (wants == RankOutput::pairs) rows.add(part, in_part);
        add_pass(in_part.statistics, statistics_.search);
    };
    search(each, [&] { return wants == RankOutput::any && found > 0; });
    if (wants == RankOutput::pairs) rows.exchange(batches_, check_, query.contacts(), result_);
    result_.count = add_up(found, wants == RankOutput::any);
    result_.any = result_.count > 0;
}

// Searches for pairs of features. each(part, features) returns the result of one part; `features` is the part in the
// form for such queries (feature_assembly.h). `listed`: true if rows are requested. `cut_short`: true if the first hit
// suffices.
template <class Each, class Result>
void RankDetector::search_features(Each each, bool listed, bool cut_short, Result& result) {
    FoundFeatures rows(transport_.size());
    std::int64_t found = 0;
    bool any = false;
    const auto one = [&](AssembledPart& part) {
        FeatureAssembly& assembly = assemblies_[part.index()];
        const auto& in_part = each(part, assembly.update(part, *demand_));
        any = any || in_part.any;
        found += in_part.count;
        if (listed) rows.add(assembly, in_part);
        add_pass(in_part.statistics, statistics_.search);
    };
    search(one, [&] { return cut_short && any; });
    if (listed) rows.exchange(batches_, check_, result);
    result.count = add_up(found, !listed);
    result.any = on_any_rank(any);
}

const DistributedImpacts& RankDetector::find(const LocalMesh& local, const ImpactQuery& query, std::stop_token stop) {
    impacts_ = {};
    run(
        local, &local.mesh.end, [&] { return request_of_ranks(query, false); }, [] {}, std::move(stop),
        [&] { search_impacts(query); });
    impacts_.statistics = statistics_;
    return impacts_;
}

void RankDetector::search_impacts(const ImpactQuery& query) {
    const bool listed = query.output == Output::pairs;
    const bool any = query.output == Output::any || query.output == Output::any_by_world;
    FirstImpact first;
    const auto each = [&](AssembledPart& part, const Part& of) -> const Impacts& {
        const Impacts& found = engine_->find(of, query, part.memory(), stop_);
        if (found.first.found && (!first.found || key_of(found.first) < key_of(first))) first = found.first;
        return found;
    };
    search_features(each, listed, any, impacts_);
    if (!any) impacts_.first = first_of_all(first);
}

const DistributedProximities& RankDetector::find(const LocalMesh& local, const ProximityQuery& query,
                                                 std::stop_token stop) {
    nearby_ = {};
    run(
        local, nullptr, [&] { return request_of_ranks(query, false); }, [] {}, std::move(stop),
        [&] { search_near(query); });
    nearby_.statistics = statistics_;
    return nearby_;
}

void RankDetector::search_near(const ProximityQuery& query) {
    nearby_.closest = query.closest && query.output == Output::pairs;
    const bool listed = query.output == Output::pairs;
    const auto each = [&](AssembledPart& part, const Part& of) -> const Proximities& {
        return engine_->find(of, query, part.memory(), stop_);
    };
    search_features(each, listed, !listed, nearby_);
}

// Returns the first impact of all ranks: least in time, then in the order of the lists. Compares keys number by number;
// a rank with a larger number drops out.
FirstImpact RankDetector::first_of_all(const FirstImpact& here) {
    constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
    const std::array<std::int64_t, 5> key = key_of(here);
    std::array<std::int64_t, 5> first{};
    bool in = here.found;
    for (std::size_t i = 0; i < key.size(); ++i) {
        first[i] = in ? key[i] : none;
        reduce({&first[i], 1}, Reduction::min);
        if (i == 0 && first[0] == none) return {};
        in = in && key[i] == first[i];
    }
    FirstImpact impact;
    impact.found = true;
    impact.toi = std::bit_cast<double>(first[0]);
    impact.kind = static_cast<FeatureKind>(first[1]);
    impact.pair = {static_cast<std::int32_t>(first[2]), static_cast<std::int32_t>(first[3])};
    impact.start = first[4] == 0;
    return impact;
}

}  // namespace crumple::distribute
