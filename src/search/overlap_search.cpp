#include "search/overlap_search.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <string>
#include <utility>

#include "crumple/error.h"
#include "results/intersection_output.h"
#include "results/overlap_output.h"

namespace crumple {
namespace {

/// The middle of what two boxes have in common: sums about it cancel least.
Vec3d middle_of(const Bounds& a, const Bounds& b) {
    Vec3d middle;
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = 0.5 * max(a.low[axis], b.low[axis]) + 0.5 * min(a.high[axis], b.high[axis]);
        if (!(std::abs(middle[axis]) >= 0x1p-150)) middle[axis] = 0;
    }
    return middle;
}

/// Pairs of triangles of one surface that have a common point, in both orders: those that were found, which lack
/// neighbours that meet in no more than what they share, and all neighbours.
std::vector<Pair> pairs_within(const ClosedSurface& surface, std::span<const Pair> found) {
    std::vector<Pair> pairs;
    for (const auto& [a, b] : found) {
        pairs.push_back({a, b});
        pairs.push_back({b, a});
    }
    std::vector<std::pair<std::int32_t, std::int32_t>> corners;  // vertex, triangle
    for (std::int32_t face = 0; face < surface.face_count(); ++face)
        for (std::size_t k = 0; k < 3; ++k) corners.emplace_back(surface.corners(face)[k], face);
    std::sort(corners.begin(), corners.end());
    for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
        while (end < corners.size() && corners[end].first == corners[begin].first) ++end;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = begin; j < end; ++j)
                if (corners[i].second != corners[j].second) pairs.push_back({corners[i].second, corners[j].second});
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

bool is_flag(Output output) { return output == Output::any || output == Output::any_by_world; }

bool in_double_word_range(const Vec3d& p) {
    for (int axis = 0; axis < 3; ++axis)
        if (p[axis] != 0 && !(std::abs(p[axis]) >= 0x1p-150 && std::abs(p[axis]) <= 0x1p150)) return false;
    return true;
}

}  // namespace

OverlapSearch::OverlapSearch(MemoryMeter& meter, Cancellation& cancellation)
    : meter_(meter),
      cancellation_(cancellation),
      outline_(&meter),
      rules_(&meter),
      near_(&meter),
      buffers_(&meter),
      buffers_of_two_(&meter),
      found_(metered(&meter)),
      pairs_(&meter) {}

void OverlapSearch::release() {
    outline_ = WorldOutline(&meter_);
    rules_ = BodyRules(&meter_);
    near_ = NearBodies(&meter_);
    buffers_ = SceneBuffers(&meter_);
    buffers_of_two_ = SceneBuffers(&meter_);
    surfaces_.clear();
    found_ = metered(&meter_);
    pairs_.release();
    candidates_.clear();
}

void OverlapSearch::find(BackendBase& backend, WorldSearch& worlds, const World& given, const OverlapQuery& query,
                         Overlaps& result) {
    query_ = query;
    World world = given;
    std::vector<Body> bodies(given.bodies.begin(), given.bodies.end());
    for (Body& body : bodies) body.self = query.self_overlaps;
    world.bodies = bodies;
    outline_.read(world, query.filter);
    rules_.prepare(query.filter);
    begin(query, outline_.worlds(), outline_.bodies(), result);
    read_surfaces(backend);
    add_skipped(list_candidates(), result);
    // Where nothing but flags is wanted, surfaces that meet decide most of it, and the search for them ends early.
    const bool by_meeting = is_flag(query.output) && query.min_volume == 0 && !query.self_overlaps && none_is_open_;
    if (!by_meeting && is_one_pair_at_rest()) {
        find_pairs_of_two(backend);
    } else {
        IntersectionQuery intersections;
        intersections.filter = query.filter;
        if (by_meeting) intersections.output = query.output;
        worlds.find(backend, world, intersections, found_);
        by_meeting ? take_flags(result) : sort_pairs();
    }
    result.statistics = found_.statistics;
    result.statistics.triangles = outline_.triangles();
    find_rows(backend, result);
    result.count = static_cast<std::int64_t>(result.bodies.size());
}

// True if there is one candidate, two bodies as they are.
bool OverlapSearch::is_one_pair_at_rest() const {
    if (candidates_.size() != 1) return false;
    const auto [a, b] = candidates_[0].bodies;
    const auto is_at_rest = [&](std::int32_t body) {
        return outline_.placement(body).identity() && outline_.shape(body).name == 0;
    };
    return a != b && is_at_rest(a) && is_at_rest(b);
}

// Backends search two meshes faster than a world.
void OverlapSearch::find_pairs_of_two(BackendBase& backend) {
    const auto mesh = [&](std::int32_t body) {
        const Shape& shape = outline_.shape(body);
        return MeshView(shape.vertices, shape.triangles);
    };
    Candidate& candidate = candidates_[0];
    const MeshView a = mesh(candidate.bodies.first), b = mesh(candidate.bodies.second);
    backend.find(prepare_scene(a, &b, false, backend, buffers_of_two_), IntersectionQuery(), nullptr, found_);
    std::swap(pairs_, found_.pairs);
    candidate.begin = 0;
    candidate.end = pairs_.size();
}

// Leaves the candidates whose worlds are not known to have a row.
void OverlapSearch::take_flags(Overlaps& result) {
    result.any = found_.any;
    if (query_.output == Output::any_by_world)
        std::copy(found_.world_hit.begin(), found_.world_hit.end(), result.world_hit.begin());
    std::erase_if(candidates_, [&](const Candidate& candidate) {
        const std::int32_t world = outline_.body(candidate.bodies.first).world;
        return query_.output == Output::any ? result.any : world >= 0 && result.world_hit[world] != 0;
    });
}

void OverlapSearch::find_rows(BackendBase& backend, Overlaps& result) {
    std::vector<OverlapRow> rows(candidates_.size());
    std::atomic<std::int64_t> rational{0};
    std::atomic<bool> enough{false};
    backend.parallel_for(candidates_.size(), [&](std::size_t i) {
        if (enough.load(std::memory_order_relaxed)) return;
        cancellation_.check();
        bool was_exact = false;
        rows[i] = row_of(backend, candidates_[i], was_exact);
        if (was_exact) rational.fetch_add(1, std::memory_order_relaxed);
        if (query_.output == Output::any && is_listed(query_, rows[i])) enough.store(true, std::memory_order_relaxed);
    });
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const BodyPair& bodies = candidates_[i].bodies;
        if (bodies.first == bodies.second) add_body(bodies.first, rows[i], result);
        if (is_listed(query_, rows[i])) add_row(query_, bodies, outline_.body(bodies.first).world, rows[i], result);
    }
    result.statistics.rational_tests += rational;
}

void OverlapSearch::read_surfaces(BackendBase& backend) {
    const auto& shapes = outline_.world().shapes;
    surfaces_.resize(shapes.size());
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        cancellation_.check();
        if (!surfaces_[s]) surfaces_[s] = std::make_unique<Surface>(&meter_);
        Surface& surface = *surfaces_[s];
        const PreparedScene scene =
            prepare_scene(MeshView(shapes[s].vertices, shapes[s].triangles), nullptr, query_.weld, backend, buffers_);
        surface.closed.prepare(scene, backend);
        surface.empty = shapes[s].triangles.rows == 0;
        surface.box = CentredBox({scene.low, scene.high});
    }
}

// From the order of first body, its triangle, second body, its triangle, to that of the candidates.
void OverlapSearch::sort_pairs() {
    std::vector<std::size_t> order(found_.pairs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto before = [&](std::size_t i, std::size_t j) { return found_.bodies[i] < found_.bodies[j]; };
    if (!std::is_sorted(order.begin(), order.end(), before)) std::stable_sort(order.begin(), order.end(), before);
    pairs_.resize_discard(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) pairs_[i] = found_.pairs[order[i]];
    std::size_t i = 0;
    for (Candidate& candidate : candidates_) {
        while (i < order.size() && found_.bodies[order[i]] < candidate.bodies) ++i;  // of surfaces that are not closed
        candidate.begin = i;
        while (i < order.size() && found_.bodies[order[i]] == candidate.bodies) ++i;
        candidate.end = i;
    }
}

// Lists the pairs of bodies whose boxes overlap, of closed surfaces. Returns the other bodies of such pairs.
std::vector<std::int32_t> OverlapSearch::list_candidates() {
    candidates_.clear();
    near_.prepare(outline_,
                  [&](std::int32_t b) { return surface(b).empty ? no_bounds : outline_.placement(b)(surface(b).box); });
    const auto add = [&](std::int32_t a, std::int32_t b) {
        if (rules_.groups(outline_.body(a).group, outline_.body(b).group)) candidates_.push_back({{a, b}, 0, 0});
    };
    for (std::int32_t w = 0; w <= outline_.worlds(); ++w)
        near_.for_each_pair(w, [&](std::int32_t a, std::int32_t b) {
            cancellation_.check();
            if (rules_.between(a, b)) add(a, b);
            return true;
        });
    for (std::int32_t b = 0; b < outline_.bodies(); ++b)
        if (rules_.within(b, query_.self_overlaps)) add(b, b);
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& x, const Candidate& y) { return x.bodies < y.bodies; });
    // Boxes of poses are a little too large: who is asked for a closed surface is told by those of the vertices.
    std::erase_if(candidates_, [&](const Candidate& candidate) {
        const auto [a, b] = candidate.bodies;
        const bool open = !surface(a).closed.closed() || !surface(b).closed.closed();
        return open && a != b && !overlap(box_of_vertices(a), box_of_vertices(b));
    });
    for (const Candidate& candidate : candidates_) {
        if (query_.open != OpenSurfaces::error) continue;
        check_closed(candidate.bodies.first);
        check_closed(candidate.bodies.second);
    }
    std::vector<std::int32_t> open;
    std::erase_if(candidates_, [&](const Candidate& candidate) {
        const auto [a, b] = candidate.bodies;
        const std::size_t before = open.size();
        for (const std::int32_t body : {a, b})
            if (!surface(body).closed.closed()) open.push_back(body);
        return open.size() != before && (query_.open == OpenSurfaces::skip || a == b);
    });
    none_is_open_ = open.empty();
    if (query_.open == OpenSurfaces::curves) open.clear();
    return open;
}

Bounds OverlapSearch::box_of_vertices(std::int32_t body) const {
    std::vector<Vec3d> points;
    return place(body, points).box;
}

void OverlapSearch::check_closed(std::int32_t body) const {
    const ClosedSurface& closed = surface(body).closed;
    if (closed.closed()) return;
    const Array<OpenEdge> open = closed.open_edges();
    fail_open_surface(body, open.size(), open[0]);
}

PlacedSurface OverlapSearch::place(std::int32_t body, std::vector<Vec3d>& points) const {
    const Shape& shape = outline_.shape(body);
    const VertexReader position = reader_of(shape);
    const Placement pose = outline_.placement(body);
    PlacedSurface placed;
    placed.surface = &surface(body).closed;
    points.resize(static_cast<std::size_t>(shape.vertices.rows));
    for (std::size_t v = 0; v < points.size(); ++v) {
        points[v] = pose(position(static_cast<std::int64_t>(v)));
        placed.box.widen(points[v]);
        placed.in_range &= in_double_word_range(points[v]);
    }
    placed.points = points.data();
    return placed;
}

OverlapRow OverlapSearch::row_of(BackendBase& backend, const Candidate& candidate, bool& was_exact) const {
    std::vector<Vec3d> points_a, points_b;
    const auto [first, second] = candidate.bodies;
    const PlacedSurface a = place(first, points_a);
    const std::span<const Pair> pairs(pairs_.data() + candidate.begin, candidate.end - candidate.begin);
    OverlapOfBodies overlap(backend, backend.overlap_kernels(), cancellation_);
    const bool numbers = query_.output == Output::pairs;
    OverlapOfBodies::Request request{.numbers = numbers,
                                     .gradient = numbers && query_.gradient,
                                     .windings = numbers && query_.windings,
                                     .curves = numbers && query_.curves};
    OverlapRow row;
    if (first == second) {
        request.orientation = orientation(first);
        row = overlap.find_self(a, pairs_within(*a.surface, pairs), middle_of(a.box, a.box), request);
    } else {
        const PlacedSurface b = place(second, points_b);
        const bool closed = a.surface->closed() && b.surface->closed();
        const Vec3d origin = middle_of(a.box, b.box);
        row = closed ? overlap.find(a, b, pairs, origin, request) : overlap.find_open(a, b, pairs, origin, request);
    }
    orient(orientation(first), orientation(second), row);
    was_exact = overlap.was_exact();
    return row;
}

}  // namespace crumple
