// Queries about bodies on a rank: searches the triangles of the bodies as a local mesh, then converts the triangles and
// features in the result to bodies and indices within bodies.

#include <algorithm>
#include <utility>

#include "distributed/rank_detector.h"
#include "distributed/transport/exchange_lists.h"

namespace crumple::distribute {
namespace {

void make_unique(std::vector<BodyPair>& pairs) {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

}  // namespace

void RankDetector::run(const LocalWorld& local, const PairFilter& rules, bool moving,
                       FunctionRef<ComparedQuery()> make_query, std::stop_token stop, FunctionRef<void()> work) {
    const auto outline = [&] {
        ComparedQuery compared = make_query();
        bodies_.outline(local, rules, moving);
        return compared;
    };
    const auto prepare = [&] {
        bodies_.number(transport_, check_);
        check_(Phase::input, [&] { bodies_.pose(engine_->workers()); });
    };
    run(bodies_.local_mesh(), moving ? &bodies_.end() : nullptr, outline, prepare, std::move(stop), work);
}

const DistributedIntersections& RankDetector::find(const LocalWorld& local, const IntersectionQuery& query,
                                                   std::stop_token stop) {
    result_ = {}, world_result_ = {};
    const auto work = [&] {
        const RankOutput wants = output_of(query);
        IntersectionQuery triangles;
        triangles.neighbours = query.neighbours;
        triangles.kind = query.kind;
        triangles.weld = query.weld;
        triangles.output = query.contacts() ? Output::contacts : Output::pairs;
        triangles.filter.groups = bodies_.rules().groups;
        triangles.filter.excluded_groups = bodies_.rules().excluded_groups;
        if (wants == RankOutput::body_pairs) return search_body_pairs(triangles);
        search_rows(triangles, wants);
        world_result_.any = result_.count > 0;
        if (wants == RankOutput::any) return;
        world_result_.count = result_.count;
        if (wants == RankOutput::pairs) check_(Phase::output, [&] { name_bodies_of_rows(); });
    };
    run(
        local, query.filter, false, [&] { return request_of_ranks(query); }, std::move(stop), work);
    world_result_.statistics = statistics_;
    return world_result_;
}

void RankDetector::name_bodies_of_rows() {
    world_result_.bodies.resize_discard(result_.pairs.size());
    world_result_.pairs.resize_discard(result_.pairs.size());
    for (std::size_t i = 0; i < result_.pairs.size(); ++i) {
        const Bodies::Within a = bodies_.triangle(result_.pairs[i].a), b = bodies_.triangle(result_.pairs[i].b);
        world_result_.bodies[i] = {a.body, b.body};
        world_result_.pairs[i] = {a.number, b.number};
    }
    world_result_.contacts = std::move(result_.contacts);
    result_ = {};
}

// Finds the pairs of bodies that collide in each part, and sends them to the rank of their first body, which removes
// duplicates.
void RankDetector::search_body_pairs(const IntersectionQuery& query) {
    std::vector<BodyPair> colliding;
    const auto each = [&](AssembledPart& part) {
        const Intersections& found = engine_->find(part.part(), query, part.memory(), stop_);
        const std::vector<std::int32_t>& ids = part.part().mesh.ids;
        for (const Pair pair : found.pairs) {
            const BodyPair bodies{bodies_.triangle(ids[static_cast<std::size_t>(pair.a)]).body,
                                  bodies_.triangle(ids[static_cast<std::size_t>(pair.b)]).body};
            if (colliding.empty() || colliding.back() != bodies) colliding.push_back(bodies);
        }
        make_unique(colliding);
        add_pass(found.statistics, statistics_.search);
    };
    search(each, [] { return false; });
    std::vector<std::vector<BodyPair>> for_rank(static_cast<std::size_t>(transport_.size()));
    check_(Phase::rows, [&] {
        for (const BodyPair& pair : colliding)
            for_rank[static_cast<std::size_t>(bodies_.rank_of(pair.first))].push_back(pair);
    });
    const Traffic traffic = traffic_of(batches_, [&](std::size_t r) { return for_rank[r].size(); });
    std::vector<BodyPair> coming;
    check_(Phase::rows, [&] { coming.resize(all(traffic.in)); });
    exchange_lists(
        batches_, traffic, [&](std::size_t r) -> auto& { return for_rank[r]; }, coming);
    check_(Phase::output, [&] {
        make_unique(coming);
        world_result_.bodies.resize_discard(coming.size());
        std::copy(coming.begin(), coming.end(), world_result_.bodies.begin());
    });
    world_result_.any = add_up(static_cast<std::int64_t>(coming.size()), true) > 0;
}

const DistributedImpacts& RankDetector::find(const LocalWorld& local, const ImpactQuery& query, std::stop_token stop) {
    impacts_ = {};
    const auto work = [&] {
        ImpactQuery of_groups = query;
        of_groups.filter = bodies_.rules();
        search_impacts(of_groups);
        name_bodies_of_features(impacts_);
        FirstImpact& first = impacts_.first;
        if (!first.found) return;
        const auto [a, b] = bodies_.features(first.kind, first.pair);
        first.pair = {a.number, b.number};
        first.bodies = {a.body, b.body};
    };
    run(
        local, query.filter, true, [&] { return request_of_ranks(query, true); }, std::move(stop), work);
    impacts_.statistics = statistics_;
    return impacts_;
}

const DistributedProximities& RankDetector::find(const LocalWorld& local, const ProximityQuery& query,
                                                 std::stop_token stop) {
    nearby_ = {};
    const auto work = [&] {
        ProximityQuery of_groups = query;
        of_groups.filter = bodies_.rules();
        search_near(of_groups);
        name_bodies_of_features(nearby_);
    };
    run(
        local, query.filter, false, [&] { return request_of_ranks(query, true); }, std::move(stop), work);
    nearby_.statistics = statistics_;
    return nearby_;
}

template <class Result>
void RankDetector::name_bodies_of_features(Result& result) {
    bodies_.count_edges(transport_, check_, features_);
    check_(Phase::output, [&] {
        for (std::size_t k = 0; k < feature_kinds; ++k) {
            auto& list = result.lists[k];
            list.bodies.resize_discard(list.pairs.size());
            for (std::size_t i = 0; i < list.pairs.size(); ++i) {
                const auto [a, b] = bodies_.features(static_cast<FeatureKind>(k), list.pairs[i]);
                list.bodies[i] = {a.body, b.body};
                list.pairs[i] = {a.number, b.number};
            }
        }
        result.edge_bodies.resize_discard(result.edges.size());
        for (std::size_t i = 0; i < result.edges.size(); ++i) {
            const Bodies::Within edge = bodies_.edge(result.edge_ids[i]);
            result.edge_ids[i] = edge.number;
            result.edge_bodies[i] = edge.body;
            const Edge ends = result.edges[i];
            result.edges[i] = {bodies_.vertex(ends.a).number, bodies_.vertex(ends.b).number};
        }
    });
}

}  // namespace crumple::distribute
