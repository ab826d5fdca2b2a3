#include "scene/joined_lists.h"

#include <algorithm>

#include "crumple/error.h"

namespace crumple {
namespace {

[[noreturn]] void fail(const std::string& what, ErrorCode code, Element element, std::size_t i) {
    throw Error(code, what, element, static_cast<std::int64_t>(i));
}

template <class Lists>
bool any_body(const WorldOutline& outline, const WorldScene& bodies, Lists lists) {
    for (std::size_t i = 0; i < bodies.added(); ++i)
        if (lists(outline.shape(bodies.added_body(i)))) return true;
    return false;
}

}  // namespace

CodimensionalFeatures checked_lists(const Shape& shape, const std::string& which) {
    const std::int64_t n = shape.vertices.rows;
    const auto outside = [&](std::int32_t v) { return v < 0 || v >= n; };
    const auto named = [&](std::int32_t v) {
        return " names vertex " + std::to_string(v) + " of " + std::to_string(n);
    };
    if (shape.edges)
        for (std::size_t e = 0; e < shape.edges->size(); ++e) {
            const Edge& edge = (*shape.edges)[e];
            const auto place = [&] { return which + "edge " + std::to_string(e); };
            for (const std::int32_t v : {edge.a, edge.b})
                if (outside(v)) fail(place() + named(v), ErrorCode::index_out_of_range, Element::edge, e);
            if (edge.a == edge.b)
                fail(place() + " has vertex " + std::to_string(edge.a) + " at both ends", ErrorCode::invalid_argument,
                     Element::edge, e);
        }
    if (shape.points)
        for (std::size_t p = 0; p < shape.points->size(); ++p)
            if (const std::int32_t v = (*shape.points)[p]; outside(v))
                fail(which + "point " + std::to_string(p) + named(v), ErrorCode::index_out_of_range, Element::point, p);
    return {shape.edges, shape.points};
}

CodimensionalFeatures JoinedLists::join(const WorldOutline& outline, const WorldScene& bodies,
                                        const PreparedScene& scene, ParallelFor& workers, SceneFeatures& features) {
    const auto lists_edges = [](const Shape& shape) { return shape.edges.has_value(); };
    const auto lists_points = [](const Shape& shape) { return shape.points.has_value(); };
    const bool edges = any_body(outline, bodies, lists_edges), points = any_body(outline, bodies, lists_points);
    CodimensionalFeatures listed;
    if (!edges && !points) return listed;
    for (std::size_t i = 0; i < bodies.added(); ++i) {
        const std::int32_t b = bodies.added_body(i);
        if (!bodies.has_only_groups(i)) checked_lists(outline.shape(b), WorldOutline::name(b));
    }
    edges_.clear();
    if (edges) {
        const bool all = !any_body(outline, bodies, [&](const Shape& shape) { return !shape.edges; });
        if (!all) features.prepare(scene, false, workers);
        join_edges(outline, bodies, all ? Array<Edge>() : features.edges());
        listed.edges = edges_.span();
    }
    if (points) {
        join_points(outline, bodies, scene);
        listed.points = points_.span();
    }
    return listed;
}

void JoinedLists::join_edges(const WorldOutline& outline, const WorldScene& bodies, const Array<Edge>& of_triangles) {
    const Edge* next = of_triangles.begin();  // sorted by lower vertex, hence by body
    for (std::size_t i = 0; i < bodies.added(); ++i) {
        const auto first = static_cast<std::int32_t>(bodies.first_vertex(i));
        const Shape& shape = outline.shape(bodies.added_body(i));
        const std::int64_t behind = bodies.end_vertex(i);
        const Edge* end = std::partition_point(next, of_triangles.end(), [&](const Edge& e) { return e.a < behind; });
        if (shape.edges && bodies.has_only_groups(i))
            for (const Edge& e : bodies.edges(i)) edges_.push_back(e);
        else if (shape.edges)
            for (const Edge& e : *shape.edges) edges_.push_back({first + e.a, first + e.b});
        else
            for (const Edge* e = next; e != end; ++e) edges_.push_back(*e);
        next = end;
    }
}

void JoinedLists::join_points(const WorldOutline& outline, const WorldScene& bodies, const PreparedScene& scene) {
    named_.assign(static_cast<std::size_t>(scene.vertex_count()), 0);
    for (std::int64_t i = 0; i < 3 * scene.triangle_count(); ++i) named_[scene.corners[i]] = 1;
    for (const Edge& e : edges_) named_[e.a] = named_[e.b] = 1;
    points_.clear();
    for (std::size_t i = 0; i < bodies.added(); ++i) {
        const auto first = static_cast<std::int32_t>(bodies.first_vertex(i));
        const Shape& shape = outline.shape(bodies.added_body(i));
        if (shape.points && bodies.has_only_groups(i))
            for (const std::int32_t v : bodies.points(i)) points_.push_back(v);
        else if (shape.points)
            for (const std::int32_t v : *shape.points) points_.push_back(first + v);
        else
            for (std::int32_t v = first; v < bodies.end_vertex(i); ++v)
                if (named_[v]) points_.push_back(v);
    }
}

}  // namespace crumple
