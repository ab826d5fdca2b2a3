#include "search/containment/closed_bodies.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <string>

#include "crumple/error.h"
#include "scene/world_scene.h"

namespace crumple {

ClosedBodies::ClosedBodies(MemoryMeter& meter, Cancellation& cancellation)
    : meter_(meter), cancellation_(cancellation), outline_(&meter), rules_(&meter), near_(&meter), buffers_(&meter) {}

void ClosedBodies::release() {
    outline_ = WorldOutline(&meter_);
    rules_ = BodyFilter(&meter_);
    near_ = NearBodies(&meter_);
    buffers_ = SceneBuffers(&meter_);
    surfaces_.clear();
}

void ClosedBodies::read(ParallelFor& workers, const World& world, const PairFilter& filter, bool weld) {
    outline_.read(world, filter);
    rules_.prepare(filter);
    read_surfaces(workers, weld);
    near_.prepare(outline_, [&](std::int32_t b) {
        return surface_of(b).empty ? no_bounds : outline_.placement(b)(surface_of(b).box);
    });
}

void ClosedBodies::read_surfaces(ParallelFor& workers, bool weld) {
    const auto& shapes = outline_.world().shapes;
    surfaces_.resize(shapes.size());
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        cancellation_.check();
        if (!surfaces_[s]) surfaces_[s] = std::make_unique<Surface>(&meter_);
        Surface& surface = *surfaces_[s];
        const PreparedScene scene = prepare_shape(s, weld, workers);
        surface.closed.prepare(scene, workers);
        surface.empty = shapes[s].triangles.rows == 0;
        surface.box = CentredBox({scene.low, scene.high});
    }
}

// Validates a shape. Errors name the first body that has it.
PreparedScene ClosedBodies::prepare_shape(std::size_t s, bool weld, ParallelFor& workers) {
    const World& world = outline_.world();
    const Shape& shape = world.shapes[s];
    try {
        return prepare_scene(MeshView(shape.vertices, shape.triangles), nullptr, weld, workers, buffers_);
    } catch (const Error& error) {
        const auto body = std::find_if(world.bodies.begin(), world.bodies.end(),
                                       [&](const Body& of) { return of.shape == static_cast<std::int32_t>(s); });
        const std::string name = body == world.bodies.end()
                                     ? "shape " + std::to_string(s) + ": "
                                     : WorldOutline::name(static_cast<std::int32_t>(body - world.bodies.begin()));
        throw Error(error.code, name + error.what(), error.element, error.index);
    }
}

Array<BodyPair> ClosedBodies::near_pairs(bool self) const {
    std::map<std::int32_t, Bounds> boxes;  // tight boxes of posed vertices
    const auto box_of_vertices = [&](std::int32_t body) {
        const auto known = boxes.find(body);
        if (known != boxes.end()) return known->second;
        if (surface(body).face_count() == 0) return boxes[body] = no_bounds;  // it occupies no space
        Array<Vec3d> points = metered_points();
        return boxes[body] = place(body, points).box;
    };
    Array<BodyPair> pairs(&meter_);
    for (std::int32_t w = 0; w <= outline_.worlds(); ++w)
        near_.for_each_pair(w, [&](std::int32_t a, std::int32_t b) {
            cancellation_.check();
            const bool wanted = rules_.between(a, b) && rules_.groups(outline_.body(a).group, outline_.body(b).group);
            if (!wanted) return true;
            const bool closed = is_closed(a) && is_closed(b);
            if (closed || overlap(box_of_vertices(a), box_of_vertices(b))) pairs.push_back({a, b});
            return true;
        });
    for (std::int32_t b = 0; self && b < outline_.bodies(); ++b)
        if (rules_.within(b, self) && rules_.groups(outline_.body(b).group, outline_.body(b).group))
            pairs.push_back({b, b});
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

std::vector<std::int32_t> ClosedBodies::open_bodies(std::span<const BodyPair> pairs, OpenSurfaces open,
                                                    const char* query) const {
    std::vector<std::int32_t> bodies;
    for (const auto& [first, second] : pairs)
        for (const std::int32_t body : {first, second}) {
            if (is_closed(body)) continue;
            if (open == OpenSurfaces::error) {
                const Array<OpenEdge> edges = surface(body).open_edges();
                fail_open_surface(body, edges.size(), edges[0], query);
            }
            bodies.push_back(body);
        }
    std::sort(bodies.begin(), bodies.end());
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    return bodies;
}

PlacedSurface ClosedBodies::place(std::int32_t body, Array<Vec3d>& points) const {
    const VertexReader position = reader_of(outline_.shape(body));
    const Placement pose = outline_.placement(body);
    PlacedSurface placed;
    placed.surface = &surface(body);
    const std::int64_t n = outline_.shape(body).vertices.rows;
    if (n == 0) return placed;
    points.resize_discard(static_cast<std::size_t>(n));
    if (pose.identity() && !position.float32 && position.contiguous())
        std::memcpy(points.data(), position.data, static_cast<std::size_t>(n) * sizeof(Vec3d));
    else
        for (std::int64_t v = 0; v < n; ++v) points[v] = pose(position(v));
    const VertexView view = rows_of_three(&points.data()->x, n);
    const ChunkCheck check = check_vertices(
        view, {static_cast<const std::byte*>(view.data), view.row_stride, view.column_stride, false}, 0, n);
    if (!check.good) fail_body_not_finite(outline_, body);
    placed.box = {check.low, check.high};
    for (const Vec3d& p : points) placed.in_range &= in_double_word_range(p);
    placed.points = points.data();
    placed.vertex_count = n;
    return placed;
}

bool ClosedBodies::may_enclose(std::int32_t a, std::int32_t b) const {
    return has_component_in_box(a, b) || has_component_in_box(b, a);
}

// True if the first vertex of some component of `body` lies in the box of `other`.
bool ClosedBodies::has_component_in_box(std::int32_t body, std::int32_t other) const {
    const VertexReader position = reader_of(outline_.shape(body));
    const Placement pose = outline_.placement(body);
    const ClosedSurface& its = surface(body);
    const Array<std::int32_t>& first = its.components();
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        const Vec3d p = pose(position(its.vertex_at_place(first[c])));
        if (overlap(Bounds{p, p}, box(other))) return true;
    }
    return false;
}

}  // namespace crumple
