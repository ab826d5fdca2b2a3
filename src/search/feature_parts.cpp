// Cuts a mesh into parts for queries about features, and searches one such part (Detector::partition, crumple/part.h;
// feature_search.h). The search uses indices within the part; at the end its rows get the ids of the mesh.

#include <algorithm>

#include "crumple/error.h"
#include "queries/checks.h"
#include "results/intersection_output.h"
#include "results/near_details.h"
#include "search/feature_search.h"

namespace crumple {
namespace {

void check_part_query(const PartFeatures& part, const ImpactQuery& query) {
    check(part.moving, "the part was made for a query about nearness");
    check(query.min_distance <= part.distance && query.min_distance_share <= part.share,
          "min_distance and min_distance_share must be at most those that the part was made for");
    check(query.weld == part.weld, "weld must be as in the query that the part was made for");
    check(!query.triangle_pairs, "triangle_pairs must be false: parts do not support them");
}
void check_part_query(const PartFeatures& part, const ProximityQuery& query) {
    check(!part.moving, "the part was made for a query about motion");
    check(query.radius <= part.distance, "radius must be at most that of the query that the part was made for");
    check(query.weld == part.weld, "weld must be as in the query that the part was made for");
    check(query.rings == part.rings, "rings must be as in the query that the part was made for");
    check(query.radii.empty() && !query.rest.data && query.rest.rows == 0,
          "radii and rest must be empty: the part has those that it was made with");
    check(query.rest_radius == 0 || !part.rest.empty() || part.vertices.empty(),
          "rest_radius needs a part that was made with a rest shape");
}

VertexReader reader_of(const std::vector<double>& xyz) {
    return {reinterpret_cast<const std::byte*>(xyz.data()), 3 * sizeof(double), sizeof(double), false};
}

}  // namespace

template <class Query>
std::vector<Part> FeatureSearch::partition(BackendBase& backend, const World& world, const Query& query, int count) {
    bodies_ = false;
    read(world, query.filter);
    const Shape& shape = outline_.shape(0);
    if constexpr (is_near<Query>) proximity_input_.begin(outline_, query, bodies_, true, backend, buffers_);
    const PreparedScene scene = prepare_in_place(backend, !is_near<Query>, query.weld);
    FeatureRequest request = request_of(query, false, features_, scene_filter_);
    if constexpr (is_near<Query>) {
        proximity_input_.place(shape);
        proximity_input_.tell(scene.vertex_count(), backend, cancellation_, request);
    }
    return make_feature_parts(scene, features_,
                              {is_motion<Query>, request.distance, request.share, query.weld, request.radii,
                               request.rest ? &request.rest->position : nullptr, request.rings, shape.groups},
                              count, backend);
}

PreparedScene FeatureSearch::prepare_part(BackendBase& backend, const Part& part, const PairFilter& rules) {
    check_feature_part(part);
    const PartFeatures& given = *part.features;
    PreparedScene scene = prepare_scene(part.mesh.view(), nullptr, false, backend, buffers_);
    if (given.moving) add_motion(end_of(given), backend, buffers_, scene);
    features_.copy_from(part);
    // Filters by classes (BodyClass) instead of groups: if faces have groups, an edge or a point of no face is in no
    // group, and so is the proxy triangle that owns it (scene_features.h); only classes can express this.
    body_filter_.prepare(rules);
    body_filter_.classes.clear();
    scene.groups = nullptr;
    if (body_filter_.allows_all_groups() && body_filter_.within(0, true)) {
        scene_filter_.prepare({});
        return scene;
    }
    const std::vector<std::int32_t>& groups = part.mesh.groups;
    std::vector<std::int32_t> distinct(groups.begin(), groups.end());
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    if (distinct.empty()) distinct.assign(1, 0);
    for (const std::int32_t group : distinct) body_filter_.classes.push_back({0, group, true, false, true});
    body_filter_.classes.push_back({0, 0, true, false, groups.empty()});
    const auto triangles = static_cast<std::size_t>(part.mesh.size());
    class_of_.resize_discard(triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::size_t proxy = t - static_cast<std::size_t>(given.faces);
        const bool lone = t >= static_cast<std::size_t>(given.faces) && given.of_no_face[proxy] != 0;
        const std::int32_t group = groups.empty() ? 0 : groups[t];
        const auto at = lone ? distinct.end() : std::lower_bound(distinct.begin(), distinct.end(), group);
        class_of_[t] = static_cast<std::int32_t>(at - distinct.begin());
    }
    scene.groups = class_of_.data();
    scene.bodies = &body_filter_;
    scene_filter_.prepare({}, &body_filter_);
    return scene;
}

template <class Query>
void FeatureSearch::find(BackendBase& backend, const Part& part, const Query& query, bool low_memory,
                         typename Query::Result& result) {
    bodies_ = false;
    low_memory_ = low_memory;
    clear(result);
    const PreparedScene scene = prepare_part(backend, part, query.filter);
    const PartFeatures& given = *part.features;
    check_part_query(given, query);
    RestShape rest;
    VertexRings rings(&meter_);
    FeatureRequest request = request_of(query, low_memory, features_, scene_filter_);
    request.part = &part;
    if constexpr (is_near<Query>) {
        check_radii("", given.radii);
        check_finite(rows_of_three(given.rest.data(), static_cast<std::int64_t>(given.rest.size() / 3)),
                     "rest shape: ", backend, buffers_);
        request.radii = given.radii;
        rest = {reader_of(given.rest), nullptr, query.rest_radius};
        if (!given.rest.empty()) request.rest = &rest;
        if (given.rings > 0) {
            rings.copy_from(given);
            request.rings = &rings;
        }
    }
    LeastDistances least;
    auto details = query;
    if constexpr (is_near<Query>) {
        if (query.least && extent(query) == Extent::all && (request.rings || request.rest)) {
            FeatureRequest all = request;
            all.rings = nullptr, all.rest = nullptr, details.least = false;
            swap_found<Query>(result);
            backend.find(scene, all, found_);
            swap_found<Query>(result);
            add_least_distances(scene, features_, backend, cancellation_, result);
            least.swap_with(result);
        }
    }
    swap_found<Query>(result);
    backend.find(scene, request, found_);
    swap_found<Query>(result);
    add_pass(found_.statistics, result.statistics);
    result.statistics.triangles = part.mesh.size();
    result.any = found_.any;
    if (query.output != Output::any) result.world_hit.assign(1, found_.any);
    if constexpr (is_motion<Query>) {
        if (extent(query) != Extent::any) {
            result.first = found_.first;
            if (result.first.found) name_globally(part, result.first.kind, result.first.pair);
            result.world_first.assign(1, result.first);
        }
    }
    if (extent(query) != Extent::all) return;
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const auto kind = static_cast<FeatureKind>(k);
        auto& list = result.lists[k];
        result.count += static_cast<std::int64_t>(list.pairs.size());
        const auto of = [&](FeatureType type) {
            if (type == FeatureType::face) return given.faces;
            return type == FeatureType::edge ? static_cast<std::int64_t>(given.edges.size()) : features_.points();
        };
        const FeatureTypes types = types_of(kind);
        if (query.index) make_index(list, of(types.first), of(types.second), cancellation_);
    }
    if constexpr (is_near<Query>) {
        add_details(scene, features_, details, backend, cancellation_, result);
        if (query.least && !details.least) least.swap_with(result);
    }
    for (std::size_t k = 0; k < feature_kinds; ++k)
        for (Pair& pair : result.lists[k].pairs) name_globally(part, static_cast<FeatureKind>(k), pair);
    result.statistics.pairs = result.count;
}

template std::vector<Part> FeatureSearch::partition(BackendBase&, const World&, const ImpactQuery&, int);
template std::vector<Part> FeatureSearch::partition(BackendBase&, const World&, const ProximityQuery&, int);
template void FeatureSearch::find(BackendBase&, const Part&, const ImpactQuery&, bool, Impacts&);
template void FeatureSearch::find(BackendBase&, const Part&, const ProximityQuery&, bool, Proximities&);

}  // namespace crumple
