#include "search/feature_search.h"

#include <algorithm>
#include <utility>

#include "queries/feature_requests.h"
#include "results/feature_output.h"
#include "results/intersection_output.h"
#include "results/near_details.h"

namespace crumple {
namespace {

bool wants_worlds(const ImpactQuery& question) { return question.output != Output::any; }
bool wants_worlds(const ProximityQuery& question) { return question.output != Output::any; }

// Whether every pair of the one body is wanted, as if there were no bodies.
bool all_wanted(const PairFilter& rules) {
    return rules.bodies != PairScope::between && rules.groups == PairScope::both && rules.excluded_bodies.empty() &&
           rules.excluded_groups.empty();
}

}  // namespace

FeatureSearch::FeatureSearch(MemoryMeter& meter, Cancellation& cancellation)
    : meter_(meter),
      cancellation_(cancellation),
      outline_(&meter),
      rules_(&meter),
      rule_(&meter),
      scene_(&meter),
      lists_(&meter),
      buffers_(&meter),
      class_of_(&meter),
      features_(&meter),
      near_input_(&meter),
      found_(&meter),
      triangle_impacts_(meter),
      found_candidates_(&meter),
      first_edge_(&meter),
      first_point_(&meter) {}

void FeatureSearch::release() {
    outline_ = WorldOutline(&meter_);
    rules_ = BodyRules(&meter_);
    rule_ = GroupRule(&meter_);
    scene_ = WorldScene(&meter_);
    lists_ = JoinedLists(&meter_);
    buffers_ = SceneBuffers(&meter_);
    class_of_.release();
    features_.release();
    near_input_.release();
    found_ = FeatureAnswer(&meter_);
    triangle_impacts_.release();
    found_candidates_ = CandidateAnswer(&meter_);
    first_edge_.release();
    first_point_.release();
}

void FeatureSearch::find(BackendBase& backend, const World& world, const ImpactQuery& question, bool bodies,
                         bool frugal, Impacts& answer) {
    bodies_ = bodies;
    frugal_ = frugal;
    search(backend, world, question, answer);
}
void FeatureSearch::find(BackendBase& backend, const World& world, const ProximityQuery& question, bool bodies,
                         bool frugal, Proximities& answer) {
    bodies_ = bodies;
    frugal_ = frugal;
    search(backend, world, question, answer);
}

template <class Question, class Answer>
void FeatureSearch::search(BackendBase& backend, const World& world, const Question& question, Answer& answer) {
    read(world, question.filter);
    clear(answer);
    answer.statistics.triangles = outline_.triangles();
    const auto worlds = static_cast<std::size_t>(outline_.worlds());
    if (wants_worlds(question)) answer.world_hit.assign(worlds, 0);
    if constexpr (is_motion<Question>)
        if (extent(question) >= Extent::first) answer.world_first.assign(worlds, FirstImpact());
    if constexpr (is_motion<Question>)
        answer.lists_triangle_pairs = question.triangle_pairs && extent(question) == Extent::all;
    if (extent(question) != Extent::any) {
        answer.first_edge.push_back(0);
        answer.first_point.push_back(0);
    }
    if constexpr (!is_motion<Question>) near_input_.begin(outline_, question, bodies_, !there_, backend, buffers_);

    if (there_ || in_place(question.filter)) {
        search_in_place(backend, question, answer);
    } else {
        for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
            cancellation_.check();
            if (!wants_worlds(question) && answer.any) break;
            search_world(backend, pass, question, answer);
        }
    }
    if (question.index && !bodies_ && extent(question) == Extent::all) {
        const Shape& shape = outline_.shape(0);
        const auto edges = static_cast<std::int64_t>(answer.edges.size());
        const auto points = shape.points ? static_cast<std::int64_t>(shape.points->size()) : shape.vertices.rows;
        make_index(answer[FeatureKind::vertex_face], points, outline_.triangles());
        make_index(answer[FeatureKind::edge_edge], edges, edges);
        make_index(answer[FeatureKind::vertex_edge], points, edges);
        make_index(answer[FeatureKind::vertex_vertex], points, points);
        if constexpr (is_motion<Question>)
            if (question.triangle_pairs) make_index(answer.triangle_pairs, outline_.triangles(), outline_.triangles());
    }
    for (auto& list : answer.lists) answer.count += static_cast<std::int64_t>(list.pairs.size());
    answer.statistics.pairs = answer.count;
}

void FeatureSearch::read(const World& world, const PairFilter& rules) {
    outline_.read(world, rules);
    rules_.prepare(rules);
}

bool FeatureSearch::in_place(const PairFilter& rules) const {
    return outline_.bodies() == 1 && outline_.placement(0).identity() && outline_.end_placement(0).identity() &&
           outline_.body(0).self && all_wanted(rules);
}

PreparedScene FeatureSearch::prepare_in_place(BackendBase& backend, bool step, bool weld) {
    const Shape& shape = outline_.shape(0);
    const MeshView mesh(shape.vertices, shape.triangles);
    PreparedScene scene = prepare_scene(mesh, nullptr, false, backend, buffers_);
    if (step && shape.end.data) add_motion(shape.end, backend, buffers_, scene);
    rule_.prepare({});
    features_.prepare(scene, weld, backend, checked_lists(shape, bodies_ ? WorldOutline::name(0) : ""));
    return features_.with_carriers(scene);
}

std::int32_t FeatureSearch::own_bodies(std::int32_t pass) const {
    const std::int32_t end = pass < outline_.worlds() ? outline_.first_body(pass + 1) : outline_.bodies();
    return end - outline_.first_body(pass);
}

std::optional<PreparedScene> FeatureSearch::prepare_pass(BackendBase& backend, std::int32_t pass, bool step,
                                                         bool weld) {
    const std::int32_t worlds = outline_.worlds(), everywhere = outline_.first_body(worlds);
    const auto float32 = [](const Shape& s) {
        return s.vertices.type == ScalarType::float32 && (!s.end.data || s.end.type == ScalarType::float32);
    };
    const auto& shapes = outline_.world().shapes;
    scene_.begin(std::all_of(shapes.begin(), shapes.end(), float32), rules_, step && outline_.moving());
    const std::int32_t begin = outline_.first_body(pass), end = begin + own_bodies(pass);
    if (begin == end) return {};
    for (std::int32_t b = begin; b < end; ++b) scene_.add(outline_, b, false, backend);
    if (pass < worlds)
        for (std::int32_t b = everywhere; b < outline_.bodies(); ++b) scene_.add(outline_, b, true, backend);
    const PreparedScene triangles = scene_.scene(outline_, false, backend);
    const ListedFeatures listed = lists_.join(outline_, scene_, triangles, backend, features_);
    features_.prepare(triangles, weld, backend, listed);
    const PreparedScene scene = scene_.with_carriers(outline_, features_, triangles);
    rule_.prepare({}, &rules_);
    place_features();
    return scene;
}

template <class Question, class Answer>
void FeatureSearch::search_in_place(BackendBase& backend, const Question& question, Answer& answer) {
    PreparedScene scene;
    if (!there_) scene = prepare_in_place(backend, is_motion<Question>, question.weld);
    if constexpr (!is_motion<Question>) near_input_.place(outline_.shape(0));
    there_ ? answer_there(backend, question) : ask(backend, scene, question);
    add_pass(found_.statistics, answer.statistics);
    answer.any = found_.any;
    if (!answer.world_hit.empty() && outline_.body(0).world >= 0) answer.world_hit[outline_.body(0).world] = found_.any;
    if (extent(question) == Extent::any) return;
    if constexpr (is_motion<Question>) {
        answer.first = found_.first;
        if (outline_.body(0).world >= 0) answer.world_first[outline_.body(0).world] = found_.first;
    }
    answer.edges = features_.edges();
    answer.first_edge.push_back(static_cast<std::int64_t>(answer.edges.size()));
    append_listed_points(0, answer);
    if (extent(question) != Extent::all) return;
    const auto take = [&](FeatureRows& rows, auto& list) {
        list.pairs.swap_elements(rows.pairs);
        values(list).swap_elements(rows.value);
        flags(list).swap_elements(rows.flag);
        if (bodies_) list.bodies.assign(list.pairs.size(), BodyPair{0, 0});
    };
    if constexpr (is_motion<Question>)
        if (question.triangle_pairs) take(triangle_impacts_.rows(), answer.triangle_pairs);
    for (std::size_t kind = 0; kind < feature_kinds; ++kind) {
        auto& list = answer.lists[kind];
        take(found_.rows[kind], list);
        if constexpr (!is_motion<Question>)
            if (question.closest)
                tell_closest(scene, features_, static_cast<FeatureKind>(kind), list.pairs, 0, backend, list);
    }
    if constexpr (!is_motion<Question>)
        if (question.least) tell_least(scene, features_, backend, answer);
}

template <class Question, class Answer>
void FeatureSearch::search_world(BackendBase& backend, std::int32_t pass, const Question& question, Answer& answer) {
    const std::optional<PreparedScene> made = prepare_pass(backend, pass, is_motion<Question>, question.weld);
    if (!made) return;
    const PreparedScene& scene = *made;
    if constexpr (!is_motion<Question>) near_input_.place(outline_, scene_);
    ask(backend, scene, question);
    add_pass(found_.statistics, answer.statistics);
    answer.any = answer.any || found_.any;
    if (!answer.world_hit.empty() && pass < outline_.worlds()) answer.world_hit[pass] = found_.any;
    if (extent(question) == Extent::any) return;
    if constexpr (is_motion<Question>) add_first(pass, answer);
    append_features(pass, answer);
    if (extent(question) != Extent::all) return;
    if constexpr (!is_motion<Question>)
        if (question.closest)
            for (std::size_t k = 0; k < feature_kinds; ++k)
                tell_closest(scene, features_, static_cast<FeatureKind>(k), found_.rows[k].pairs,
                             answer.lists[k].pairs.size(), backend, answer.lists[k]);
    for (std::size_t k = 0; k < feature_kinds; ++k)
        append_rows(types_of(static_cast<FeatureKind>(k)), found_.rows[k], answer.lists[k]);
    if constexpr (is_motion<Question>)
        if (question.triangle_pairs)
            append_rows({FeatureType::face, FeatureType::face}, triangle_impacts_.rows(), answer.triangle_pairs);
    if constexpr (!is_motion<Question>)
        if (question.least) tell_least(scene, features_, backend, answer);
}

template <class Question>
void FeatureSearch::ask(BackendBase& backend, const PreparedScene& scene, const Question& question) {
    FeatureRequest query = query_of(question, frugal_, features_, rule_);
    if constexpr (!is_motion<Question>) near_input_.tell(scene.vertex_count(), backend, cancellation_, query);
    backend.find(scene, query, found_);
    if constexpr (is_motion<Question>)
        if (question.triangle_pairs) ask_for_triangles(backend, scene, question);
}

void FeatureSearch::ask_for_triangles(BackendBase& backend, const PreparedScene& scene, const ImpactQuery& question) {
    if (extent(question) == Extent::all) {
        triangle_impacts_.find(backend, scene, features_, rule_, found_, found_.statistics);
        found_.any = found_.any || !triangle_impacts_.rows().pairs.empty();
    } else if (!found_.any) {
        found_.any = triangle_impacts_.any_at_start(backend, scene, features_);
    }
}

// Edges and points of each body lie together, in the order of the bodies.
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
void FeatureSearch::append_rows(FeatureTypes types, const FeatureRows& rows, List& list) {
    const std::size_t more = rows.pairs.size();
    list.pairs.make_room_for(more);
    if (bodies_) list.bodies.make_room_for(more);
    values(list).make_room_for(more);
    flags(list).make_room_for(more);
    for (std::size_t i = 0; i < more; ++i) {
        Pair pair;
        BodyPair bodies;
        place(types, rows.pairs[i], pair, bodies);
        list.pairs.push_back(pair);
        if (bodies_) list.bodies.push_back(bodies);
        values(list).push_back(rows.value[i]);
        flags(list).push_back(rows.flag[i]);
    }
}

void FeatureSearch::find(BackendBase& backend, const World& world, const CandidateQuery& question, bool bodies,
                         bool frugal, Candidates& answer) {
    bodies_ = bodies;
    frugal_ = frugal;
    search(backend, world, question, answer);
}

void FeatureSearch::search(BackendBase& backend, const World& world, const CandidateQuery& question,
                           Candidates& answer) {
    read(world, question.filter);
    clear(answer);
    for (const CandidateKind kind : question.kinds) answer.listed[static_cast<std::size_t>(kind)] = true;
    answer.statistics.triangles = outline_.triangles();
    answer.first_edge.push_back(0);
    answer.first_point.push_back(0);
    if (there_ || in_place(question.filter)) {
        search_in_place(backend, question, answer);
    } else {
        for (std::int32_t pass = 0; pass <= outline_.worlds(); ++pass) {
            cancellation_.check();
            search_world(backend, pass, question, answer);
        }
    }
    for (const CandidateList& list : answer.lists) answer.count += static_cast<std::int64_t>(list.pairs.size());
    answer.any = answer.count > 0;
    answer.statistics.pairs = answer.count;
}

void FeatureSearch::search_in_place(BackendBase& backend, const CandidateQuery& question, Candidates& answer) {
    if (there_) {
        answer_there(backend, question);
    } else {
        const PreparedScene scene = prepare_in_place(backend, true, question.weld);
        backend.find(scene, query_of(question, frugal_, features_, rule_), found_candidates_);
    }
    add_pass(found_candidates_.statistics, answer.statistics);
    answer.edges = features_.edges();
    answer.first_edge.push_back(static_cast<std::int64_t>(answer.edges.size()));
    append_listed_points(0, answer);
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        CandidateList& list = answer.lists[k];
        list.pairs.swap_elements(found_candidates_.pairs[k]);
        if (bodies_) list.bodies.assign(list.pairs.size(), BodyPair{0, 0});
    }
}

void FeatureSearch::search_world(BackendBase& backend, std::int32_t pass, const CandidateQuery& question,
                                 Candidates& answer) {
    const std::optional<PreparedScene> scene = prepare_pass(backend, pass, true, question.weld);
    if (!scene) return;
    backend.find(*scene, query_of(question, frugal_, features_, rule_), found_candidates_);
    add_pass(found_candidates_.statistics, answer.statistics);
    append_features(pass, answer);
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        CandidateList& list = answer.lists[k];
        const Array<Pair>& found = found_candidates_.pairs[k];
        list.pairs.make_room_for(found.size());
        if (bodies_) list.bodies.make_room_for(found.size());
        for (const Pair& pair : found) {
            Pair placed;
            BodyPair bodies;
            place(types_of(static_cast<CandidateKind>(k)), pair, placed, bodies);
            list.pairs.push_back(placed);
            if (bodies_) list.bodies.push_back(bodies);
        }
    }
}

void FeatureSearch::add_first(std::int32_t pass, Impacts& answer) const {
    FirstImpact first = found_.first;
    if (!first.found) return;
    place(types_of(first.kind), found_.first.pair, first.pair, first.bodies);
    if (pass < outline_.worlds()) answer.world_first[pass] = first;
    const auto key = [](const FirstImpact& f) { return std::pair(f.toi, f.kind); };
    if (!answer.first.found || key(first) < key(answer.first)) answer.first = first;
}

template void FeatureSearch::search(BackendBase&, const World&, const ImpactQuery&, Impacts&);
template void FeatureSearch::search(BackendBase&, const World&, const ProximityQuery&, Proximities&);

}  // namespace crumple
