#include "search/feature_search.h"

#include <algorithm>
#include <utility>

#include "results/intersection_output.h"
#include "results/near_details.h"

namespace crumple {
namespace {

// True if one hit in any of the worlds is enough.
template <class Query>
bool is_any_output(const Query& query) {
    if constexpr (is_candidates<Query>)
        return false;
    else
        return query.output == Output::any;
}

// Records whether a world has a hit. `world`: its index, or -1 for pairs among bodies that are in all worlds.
template <class Result>
void set_hit(std::int32_t world, bool hit, Result& result) {
    result.any = result.any || hit;
    if constexpr (requires { result.world_hit; })
        if (!result.world_hit.empty() && world >= 0) result.world_hit[world] = hit;
}

// True if the filter selects every pair within a single body.
bool selects_all(const PairFilter& rules) {
    return rules.bodies != PairScope::between && rules.groups == PairScope::both && rules.excluded_bodies.empty() &&
           rules.excluded_groups.empty();
}

}  // namespace

FeatureSearch::FeatureSearch(MemoryMeter& meter, Cancellation& cancellation, ShapeTrees& trees)
    : meter_(meter),
      cancellation_(cancellation),
      outline_(&meter),
      body_filter_(&meter),
      scene_filter_(&meter),
      clear_(meter, cancellation, trees),
      scene_(&meter),
      lists_(&meter),
      buffers_(&meter),
      class_of_(&meter),
      features_(&meter),
      proximity_input_(&meter),
      found_(&meter),
      triangle_impacts_(meter),
      first_edge_(&meter),
      first_point_(&meter) {}

void FeatureSearch::release() {
    outline_ = WorldOutline(&meter_);
    body_filter_ = BodyFilter(&meter_);
    scene_filter_ = SceneFilter(&meter_);
    clear_.release();
    scene_ = WorldScene(&meter_);
    lists_ = JoinedLists(&meter_);
    buffers_ = SceneBuffers(&meter_);
    class_of_.release();
    features_.release();
    proximity_input_.release();
    found_ = FeatureResult(&meter_);
    triangle_impacts_.release();
    first_edge_.release();
    first_point_.release();
}

// Searches twice, once for the least distances and once for the lists: least distances include pairs that `rings` and
// `rest` drop from the lists.
void FeatureSearch::search_with_least(BackendBase& backend, const World& world, const ProximityQuery& query,
                                      Proximities& result) {
    Shape all = world.shapes[0];
    all.rest = {};
    ProximityQuery near = query, listed = query;
    near.rings = 0, near.rest_radius = 0, near.closest = near.index = listed.least = false;
    search(backend, World{{&all, 1}, world.bodies, world.poses}, near, result);
    LeastDistances least;
    least.swap_with(result);
    search(backend, world, listed, result);
    least.swap_with(result);
}

template <class Query>
void FeatureSearch::search(BackendBase& backend, const World& world, const Query& query,
                           typename Query::Result& result) {
    if constexpr (is_near<Query>) {
        if (query.least && extent(query) == Extent::all && world.shapes.size() == 1 &&
            (query.rings > 0 || world.shapes[0].rest.data))
            return search_with_least(backend, world, query, result);
    }
    read(world, query.filter);
    clear(result);
    result.statistics.triangles = outline_.triangles();
    const auto worlds = static_cast<std::size_t>(outline_.worlds());
    if constexpr (is_candidates<Query>)
        result.listed = listed_kinds(query);
    else if (!is_any_output(query))
        result.world_hit.assign(worlds, 0);
    if constexpr (is_motion<Query>) {
        if (extent(query) != Extent::any) result.world_first.assign(worlds, FirstImpact());
        result.lists_triangle_pairs = query.triangle_pairs && extent(query) == Extent::all;
    }
    if (extent(query) != Extent::any) {
        result.first_edge.push_back(0);
        result.first_point.push_back(0);
    }
    if constexpr (is_near<Query>) proximity_input_.begin(outline_, query, bodies_, !device_mesh_, backend, buffers_);

    if (device_mesh_ || in_place(query.filter)) {
        search_in_place(backend, query, result);
    } else {
        read_clear_worlds(backend, query);
        // Worlds are decided in batches: with Output::any, because a hit in the first ones makes the others
        // unnecessary; else, because marks take memory.
        constexpr std::int32_t most_at_once = 512;
        const bool any = is_any_output(query);
        std::int32_t decided = 0, batch = any ? 1 : most_at_once;
        for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
            cancellation_.check();
            if (pass == decided) {
                decided += std::min(batch, outline_.worlds() + 1 - decided);
                batch = std::min(most_at_once, 4 * batch);
                clear_.decide(backend, pass, decided, any);
            }
            if (any && (clear_.any_hit() || result.any)) {
                result.any = true;
                break;
            }
            search_pass(backend, pass, query, result);
        }
    }
    if constexpr (!is_candidates<Query>)
        if (query.index && !bodies_ && extent(query) == Extent::all) index_lists(query, result);
    for (const auto& list : result.lists) result.count += static_cast<std::int64_t>(list.pairs.size());
    result.statistics.pairs = result.count;
}

template <class Query>
void FeatureSearch::search_pass(BackendBase& backend, std::int32_t pass, const Query& query,
                                typename Query::Result& result) {
    using Verdict = ClearWorlds::Verdict;
    const Verdict verdict = clear_.verdict(pass);
    const std::span<const ClearWorlds::Mark> marked = clear_.marked(pass);
    if (extent(query) == Extent::any) {
        if (verdict == Verdict::search)
            search_world(backend, pass, query, marked, result);
        else
            set_hit(world_of(pass), verdict == Verdict::hit, result);
        return;
    }
    // Rows need whole bodies, so marked groups only decide whether there are any rows.
    if (verdict == Verdict::clear || (!marked.empty() && !any_among(backend, pass, query, marked, result)))
        append_features_of_clear_world(pass, result);
    else
        search_world(backend, pass, query, {}, result);
}

// No world is left out under a memory limit, where the trees would take memory from the scenes; for the reference
// backend, which has to test everything; for least distances; and for a minimum distance that is a share of the
// distance at the start.
template <class Query>
void FeatureSearch::read_clear_worlds(const BackendBase& backend, const Query& query) {
    clear_.forget();
    if (meter_.limit > 0 || backend.by_brute_force()) return;
    const bool subsets = parts_suffice(query);
    if constexpr (is_motion<Query>) {
        if (query.min_distance_share == 0) clear_.read(outline_, body_filter_, true, query.min_distance, subsets);
    } else if constexpr (is_near<Query>) {
        if (!query.least) clear_.read(outline_, body_filter_, false, query.radius, subsets);
    }
}

template <class Query>
void FeatureSearch::index_lists(const Query& query, typename Query::Result& result) const {
    const Shape& shape = outline_.shape(0);
    const auto edges = static_cast<std::int64_t>(result.edges.size());
    const auto points = shape.points ? static_cast<std::int64_t>(shape.points->size()) : shape.vertices.rows;
    make_index(result[FeatureKind::vertex_face], points, outline_.triangles(), cancellation_);
    make_index(result[FeatureKind::edge_edge], edges, edges, cancellation_);
    make_index(result[FeatureKind::vertex_edge], points, edges, cancellation_);
    make_index(result[FeatureKind::vertex_vertex], points, points, cancellation_);
    if constexpr (is_motion<Query>)
        if (query.triangle_pairs)
            make_index(result.triangle_pairs, outline_.triangles(), outline_.triangles(), cancellation_);
}

void FeatureSearch::read(const World& world, const PairFilter& rules) {
    outline_.read(world, rules);
    body_filter_.prepare(rules);
}

bool FeatureSearch::in_place(const PairFilter& rules) const {
    return outline_.bodies() == 1 && outline_.placement(0).identity() && outline_.end_placement(0).identity() &&
           outline_.body(0).self && selects_all(rules);
}

PreparedScene FeatureSearch::prepare_in_place(BackendBase& backend, bool step, bool weld) {
    const Shape& shape = outline_.shape(0);
    const MeshView mesh(shape.vertices, shape.triangles);
    PreparedScene scene = prepare_scene(mesh, nullptr, false, backend, buffers_);
    if (step && shape.end.data) add_motion(shape.end, backend, buffers_, scene);
    scene_filter_.prepare({});
    features_.prepare(scene, weld, backend, checked_lists(shape, bodies_ ? WorldOutline::name(0) : ""));
    return features_.with_proxies(scene);
}

std::int32_t FeatureSearch::own_bodies(std::int32_t pass) const {
    const std::int32_t end = pass < outline_.worlds() ? outline_.first_body(pass + 1) : outline_.bodies();
    return end - outline_.first_body(pass);
}

std::optional<PreparedScene> FeatureSearch::prepare_pass(BackendBase& backend, std::int32_t pass, bool step, bool weld,
                                                         std::span<const ClearWorlds::Mark> marked) {
    const std::int32_t worlds = outline_.worlds(), everywhere = outline_.first_body(worlds);
    const auto float32 = [](const Shape& s) {
        return s.vertices.type == ScalarType::float32 && (!s.end.data || s.end.type == ScalarType::float32);
    };
    const auto& shapes = outline_.world().shapes;
    scene_.begin(std::all_of(shapes.begin(), shapes.end(), float32), body_filter_, step && outline_.moving());
    const std::int32_t begin = outline_.first_body(pass), end = begin + own_bodies(pass);
    if (begin == end) return {};
    if (!marked.empty()) {
        add_marked(pass, marked);
    } else {
        for (std::int32_t b = begin; b < end; ++b) scene_.add(outline_, b, false, backend);
        if (pass < worlds)
            for (std::int32_t b = everywhere; b < outline_.bodies(); ++b) scene_.add(outline_, b, true, backend);
    }
    const PreparedScene triangles = scene_.scene(outline_, false, backend);
    const CodimensionalFeatures listed = lists_.join(outline_, scene_, triangles, backend, features_);
    features_.prepare(triangles, weld, backend, listed);
    const PreparedScene scene = scene_.with_proxies(outline_, features_, triangles);
    scene_filter_.prepare({}, &body_filter_);
    place_features();
    return scene;
}

void FeatureSearch::add_marked(std::int32_t pass, std::span<const ClearWorlds::Mark> marked) {
    std::vector<std::int32_t> groups;
    for (auto m = marked.begin(); m != marked.end();) {
        const std::int32_t b = m->body;
        groups.clear();
        for (; m != marked.end() && m->body == b; ++m) groups.push_back(m->group);
        const bool everywhere = pass < outline_.worlds() && b >= outline_.first_body(outline_.worlds());
        scene_.add(outline_, b, everywhere, clear_.tree(b), groups, {});
    }
}

// True if the marked groups can be searched without the other elements of their bodies. This is not so with welding,
// which depends on the positions of all vertices; nor if shapes have groups: a vertex or an edge then is in the group
// of the triangle that owns it, which may be one of the others; nor for approaching features of shapes with lists: a
// listed edge or point that belongs to a triangle has no test with a vertex, but would have one without that triangle.
template <class Query>
bool FeatureSearch::parts_suffice(const Query& query) const {
    bool allows_lists = true;
    if constexpr (is_motion<Query>) allows_lists = !query.approaching_only;
    const auto& shapes = outline_.world().shapes;
    return !query.weld && std::all_of(shapes.begin(), shapes.end(), [&](const Shape& s) {
        return s.groups.empty() && (allows_lists || (!s.edges && !s.points));
    });
}

template <class Query>
void FeatureSearch::search_in_place(BackendBase& backend, const Query& query, typename Query::Result& result) {
    PreparedScene scene;
    if (!device_mesh_) scene = prepare_in_place(backend, !is_near<Query>, query.weld);
    if constexpr (is_near<Query>) proximity_input_.place(outline_.shape(0));
    swap_found<Query>(result);
    device_mesh_ ? find_rows_on_device(backend, query) : find_rows(backend, scene, query);
    swap_found<Query>(result);
    add_pass(found_.statistics, result.statistics);
    const std::int32_t world = outline_.body(0).world;
    set_hit(world, found_.any, result);
    if (extent(query) == Extent::any) return;
    if constexpr (is_motion<Query>) {
        result.first = found_.first;
        if (world >= 0) result.world_first[world] = found_.first;
    }
    result.edges = features_.edges();
    result.first_edge.push_back(static_cast<std::int64_t>(result.edges.size()));
    append_codimensional_points(0, result);
    if (extent(query) != Extent::all) return;
    const auto name_body = [&](auto& list) {
        if (bodies_) list.bodies.assign(list.pairs.size(), BodyPair{0, 0});
    };
    for (auto& list : result.lists) name_body(list);
    if constexpr (is_motion<Query>) {
        if (!query.triangle_pairs) return;
        swap_rows(result.triangle_pairs, triangle_impacts_.rows());
        name_body(result.triangle_pairs);
    }
    if constexpr (is_near<Query>) add_details(scene, features_, query, backend, cancellation_, result);
}

template <class Query>
bool FeatureSearch::any_among(BackendBase& backend, std::int32_t pass, Query query,
                              std::span<const ClearWorlds::Mark> marked, typename Query::Result& result) {
    if constexpr (!is_candidates<Query>) {
        query.output = Output::any;
        const std::optional<PreparedScene> made = prepare_pass(backend, pass, !is_near<Query>, query.weld, marked);
        if (!made) return false;
        if constexpr (is_near<Query>) proximity_input_.place(outline_, scene_);
        find_rows(backend, *made, query);
        add_pass(found_.statistics, result.statistics);
        return found_.any;
    }
    return true;
}

template <class Query>
void FeatureSearch::search_world(BackendBase& backend, std::int32_t pass, const Query& query,
                                 std::span<const ClearWorlds::Mark> marked, typename Query::Result& result) {
    const std::optional<PreparedScene> made = prepare_pass(backend, pass, !is_near<Query>, query.weld, marked);
    if (!made) return;
    const PreparedScene& scene = *made;
    if constexpr (is_near<Query>) proximity_input_.place(outline_, scene_);
    find_rows(backend, scene, query);
    add_pass(found_.statistics, result.statistics);
    set_hit(world_of(pass), found_.any, result);
    if (extent(query) == Extent::any) return;
    if constexpr (is_motion<Query>) add_first(pass, result);
    append_features(pass, result);
    if (extent(query) != Extent::all) return;
    for (std::size_t k = 0; k < result.lists.size(); ++k) {
        const auto kind = static_cast<KindOf<Query>>(k);
        const FeatureRows& rows = found_.rows[kind];
        append_rows(types_of(kind), rows, false, result.lists[k]);
        if constexpr (is_near<Query>)
            if (query.closest) append_closest(scene, features_, kind, rows.pairs, &backend, result.lists[k]);
    }
    if constexpr (is_motion<Query>)
        if (query.triangle_pairs)
            append_rows(types_of(CandidateKind::face_face), triangle_impacts_.rows(), false, result.triangle_pairs);
    if constexpr (is_near<Query>)
        if (query.least) add_least_distances(scene, features_, backend, cancellation_, result);
}

template <class Query>
void FeatureSearch::find_rows(BackendBase& backend, const PreparedScene& scene, const Query& query) {
    FeatureRequest request = request_of(query, low_memory_, features_, scene_filter_);
    if constexpr (is_near<Query>) proximity_input_.tell(scene.vertex_count(), backend, cancellation_, request);
    backend.find(scene, request, found_);
    if constexpr (is_motion<Query>)
        if (query.triangle_pairs) find_triangle_pairs(backend, scene, query);
}

void FeatureSearch::find_triangle_pairs(BackendBase& backend, const PreparedScene& scene, const ImpactQuery& query) {
    if (extent(query) == Extent::all) {
        triangle_impacts_.find(backend, scene, features_, scene_filter_, found_.rows, found_.statistics);
        found_.any = found_.any || !triangle_impacts_.rows().pairs.empty();
    } else if (!found_.any) {
        found_.any = triangle_impacts_.any_at_start(backend, scene, features_);
    }
}

// Sets first_edge_ and first_point_. The edges and points of each body are contiguous, in the order of the bodies.
void FeatureSearch::place_features() {
    const Array<Edge>& edges = features_.edges();
    first_edge_.resize_discard(scene_.added() + 1);
    first_point_.resize_discard(scene_.added() + 1);
    for (std::size_t i = 0; i < scene_.added(); ++i) {
        const auto first = static_cast<std::int32_t>(scene_.first_vertex(i));
        first_edge_[i] = std::partition_point(edges.begin(), edges.end(), [&](const Edge& e) { return e.a < first; }) -
                         edges.begin();
        first_point_[i] = features_.points_below(first);
    }
    first_edge_[scene_.added()] = static_cast<std::int64_t>(edges.size());
    first_point_[scene_.added()] = features_.points();
}

FeatureSearch::Place FeatureSearch::point(std::int32_t p) const {
    const std::int32_t v = features_.vertex_of(p);
    const std::size_t i = scene_.added_of(v);
    const std::int32_t b = scene_.added_body(i);
    if (outline_.shape(b).points) return {b, p - static_cast<std::int32_t>(first_point_[i])};
    return {b, v - static_cast<std::int32_t>(scene_.first_vertex(i))};
}
FeatureSearch::Place FeatureSearch::edge(std::int32_t e) const {
    const std::size_t i = scene_.added_of(features_.edges()[e].a);
    return {scene_.added_body(i), e - static_cast<std::int32_t>(first_edge_[i])};
}
FeatureSearch::Place FeatureSearch::triangle(std::int32_t t) const { return {scene_.body(t), scene_.triangle(t)}; }

FeatureSearch::Place FeatureSearch::place(FeatureType type, std::int32_t i) const {
    return type == FeatureType::vertex ? point(i) : type == FeatureType::edge ? edge(i) : triangle(i);
}

void FeatureSearch::place(FeatureTypes types, const Pair& found, Pair& pair, BodyPair& bodies) const {
    const Place a = place(types.first, found.a), b = place(types.second, found.b);
    pair = {a.index, b.index};
    bodies = {a.body, b.body};
}

template <class List>
void FeatureSearch::append_rows(FeatureTypes types, const FeatureRows& rows, bool in_place, List& list) const {
    list.pairs.grow_by(rows.size());
    if (bodies_) list.bodies.grow_by(rows.size());
    if constexpr (has_values<List>) {
        values(list).grow_by(rows.size());
        flags(list).grow_by(rows.size());
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        Pair pair = rows.pairs[i];
        BodyPair bodies{0, 0};
        if (!in_place) place(types, rows.pairs[i], pair, bodies);
        list.pairs.push_back(pair);
        if (bodies_) list.bodies.push_back(bodies);
        if constexpr (has_values<List>) {
            values(list).push_back(rows.value[i]);
            flags(list).push_back(rows.flag[i]);
        }
    }
}
template void FeatureSearch::append_rows(FeatureTypes, const FeatureRows&, bool, ImpactList&) const;
template void FeatureSearch::append_rows(FeatureTypes, const FeatureRows&, bool, ProximityList&) const;
template void FeatureSearch::append_rows(FeatureTypes, const FeatureRows&, bool, CandidateList&) const;

void FeatureSearch::add_first(std::int32_t pass, Impacts& result) const {
    FirstImpact first = found_.first;
    if (!first.found) return;
    place(types_of(first.kind), found_.first.pair, first.pair, first.bodies);
    if (pass < outline_.worlds()) result.world_first[pass] = first;
    const auto key = [](const FirstImpact& f) { return std::pair(f.toi, f.kind); };
    if (!result.first.found || key(first) < key(result.first)) result.first = first;
}

template void FeatureSearch::search(BackendBase&, const World&, const ImpactQuery&, Impacts&);
template void FeatureSearch::search(BackendBase&, const World&, const ProximityQuery&, Proximities&);
template void FeatureSearch::search(BackendBase&, const World&, const CandidateQuery&, Candidates&);

}  // namespace crumple
