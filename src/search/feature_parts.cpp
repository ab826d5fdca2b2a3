// Public parts of a scene that is asked about its features: how they are made, and how one is answered
// (feature_search.h). Everything is searched as it counts within the part, and called by its id in the end.

#include <algorithm>

#include "crumple/error.h"
#include "queries/checks.h"
#include "queries/feature_requests.h"
#include "results/feature_output.h"
#include "results/intersection_output.h"
#include "results/near_details.h"
#include "search/feature_search.h"

namespace crumple {
namespace {

void check_asked(const PartFeatures& part, const ImpactQuery& question) {
    check(part.moving, "the part was made for a question about nearness");
    check(question.min_distance <= part.distance && question.min_distance_share <= part.share,
          "min_distance and min_distance_share must be at most those that the part was made for");
    check(question.weld == part.weld, "weld must be as the part was made");
    check(!question.triangle_pairs, "triangle_pairs must be false: parts of features have none");
}
void check_asked(const PartFeatures& part, const ProximityQuery& question) {
    check(!part.moving, "the part was made for a question about motion");
    check(question.radius <= part.distance, "radius must be at most that which the part was made for");
    check(question.weld == part.weld, "weld must be as the part was made");
    check(question.rings == part.rings, "rings must be as the part was made");
    check(question.radii.empty() && !question.rest.data && question.rest.rows == 0,
          "a part knows radii and the shape at rest: it was made with them");
    check(question.rest_radius == 0 || !part.rest.empty() || part.vertices.empty(),
          "rest_radius needs a part that was made with a shape at rest");
}

VertexReader reader_of(const std::vector<double>& xyz) {
    return {reinterpret_cast<const std::byte*>(xyz.data()), 3 * sizeof(double), sizeof(double), false};
}

}  // namespace

template <class Question>
std::vector<Part> FeatureSearch::partition(BackendBase& backend, const World& world, const Question& question,
                                           int count) {
    bodies_ = false;
    read(world, question.filter);
    const Shape& shape = outline_.shape(0);
    if constexpr (!is_motion<Question>) near_input_.begin(outline_, question, bodies_, true, backend, buffers_);
    const PreparedScene scene = prepare_in_place(backend, is_motion<Question>, question.weld);
    FeatureRequest query = query_of(question, false, features_, rule_);
    if constexpr (!is_motion<Question>) {
        near_input_.place(shape);
        near_input_.tell(scene.vertex_count(), backend, cancellation_, query);
    }
    return make_feature_parts(scene, features_,
                              {query.motion, query.distance, query.share, question.weld, query.radii,
                               query.rest ? &query.rest->position : nullptr, query.rings, shape.groups},
                              count, backend);
}

PreparedScene FeatureSearch::prepare_part(BackendBase& backend, const Part& part, const PairFilter& rules) {
    check_feature_part(part);
    const PartFeatures& given = *part.features;
    PreparedScene scene = prepare_scene(part.mesh.view(), nullptr, false, backend, buffers_);
    if (given.moving) add_motion(end_of(given), backend, buffers_, scene);
    features_.adopt(part);
    // Classes, for what no face is behind is of no group where faces have some.
    rules_.prepare(rules);
    rules_.classes.clear();
    scene.groups = nullptr;
    if (rules_.any_group() && rules_.within(0, true)) {
        rule_.prepare({});
        return scene;
    }
    const std::vector<std::int32_t>& groups = part.mesh.groups;
    std::vector<std::int32_t> distinct(groups.begin(), groups.end());
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    if (distinct.empty()) distinct.assign(1, 0);
    for (const std::int32_t group : distinct) rules_.classes.push_back({0, group, true, false, true});
    rules_.classes.push_back({0, 0, true, false, groups.empty()});
    const auto triangles = static_cast<std::size_t>(part.mesh.size());
    class_of_.resize_discard(triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::size_t carrier = t - static_cast<std::size_t>(given.faces);
        const bool lone = t >= static_cast<std::size_t>(given.faces) && given.of_no_face[carrier] != 0;
        const std::int32_t group = groups.empty() ? 0 : groups[t];
        const auto at = lone ? distinct.end() : std::lower_bound(distinct.begin(), distinct.end(), group);
        class_of_[t] = static_cast<std::int32_t>(at - distinct.begin());
    }
    scene.groups = class_of_.data();
    scene.bodies = &rules_;
    rule_.prepare({}, &rules_);
    return scene;
}

template <class Question, class Answer>
void FeatureSearch::find(BackendBase& backend, const Part& part, const Question& question, bool frugal,
                         Answer& answer) {
    constexpr bool motion = is_motion<Question>;
    bodies_ = false;
    frugal_ = frugal;
    clear(answer);
    const PreparedScene scene = prepare_part(backend, part, question.filter);
    const PartFeatures& given = *part.features;
    check_asked(given, question);
    RestShape rest;
    VertexRings rings(&meter_);
    FeatureRequest query = query_of(question, frugal, features_, rule_);
    query.part = &part;
    if constexpr (!motion) {
        check_radii("", given.radii);
        check_finite(rows_of_three(given.rest.data(), static_cast<std::int64_t>(given.rest.size() / 3)),
                     "at rest: ", backend, buffers_);
        query.radii = given.radii;
        rest = {reader_of(given.rest), nullptr, question.rest_radius};
        if (!given.rest.empty()) query.rest = &rest;
        if (given.rings > 0) {
            rings.adopt(given);
            query.rings = &rings;
        }
    }
    backend.find(scene, query, found_);
    add_pass(found_.statistics, answer.statistics);
    answer.statistics.triangles = part.mesh.size();
    answer.any = found_.any;
    const auto kind_of = [](std::size_t k) { return static_cast<FeatureKind>(k); };
    if constexpr (motion) {
        if (question.output != Output::any) answer.world_hit.assign(1, found_.any);
        if (extent(question) != Extent::any) {
            answer.first = found_.first;
            if (answer.first.found) name_globally(part, answer.first.kind, answer.first.pair);
            answer.world_first.assign(1, answer.first);
        }
    } else {
        if (question.output != Output::any) answer.world_hit.assign(1, found_.any);
    }
    if (extent(question) != Extent::all) return;
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        auto& list = answer.lists[k];
        list.pairs.swap_elements(found_.rows[k].pairs);
        values(list).swap_elements(found_.rows[k].value);
        flags(list).swap_elements(found_.rows[k].flag);
        answer.count += static_cast<std::int64_t>(list.pairs.size());
        if constexpr (!motion)
            if (question.closest) tell_closest(scene, features_, kind_of(k), list.pairs, 0, backend, list);
        const auto of = [&](FeatureType type) {
            if (type == FeatureType::face) return given.faces;
            return type == FeatureType::edge ? static_cast<std::int64_t>(given.edges.size()) : features_.points();
        };
        const FeatureTypes types = types_of(kind_of(k));
        if (question.index) make_index(list, of(types.first), of(types.second));
    }
    if constexpr (!motion)
        if (question.least) tell_least(scene, features_, backend, answer);
    for (std::size_t k = 0; k < feature_kinds; ++k)
        for (Pair& pair : answer.lists[k].pairs) name_globally(part, kind_of(k), pair);
    answer.statistics.pairs = answer.count;
}

template std::vector<Part> FeatureSearch::partition(BackendBase&, const World&, const ImpactQuery&, int);
template std::vector<Part> FeatureSearch::partition(BackendBase&, const World&, const ProximityQuery&, int);
template void FeatureSearch::find(BackendBase&, const Part&, const ImpactQuery&, bool, Impacts&);
template void FeatureSearch::find(BackendBase&, const Part&, const ProximityQuery&, bool, Proximities&);

}  // namespace crumple
