// Finds the triangles that own the listed (codimensional) edges and points. For each of these features that no triangle
// owns, adds a proxy triangle: a degenerate triangle that owns it (scene_features.h).

#include <algorithm>
#include <atomic>

#include "scene/scene_features.h"

namespace crumple {
namespace {

// Value of owner_[e] for a listed edge e that a triangle owns, so that it needs no proxy triangle.
constexpr std::int32_t owned_by_triangle = -2;

}  // namespace

PreparedScene SceneFeatures::with_proxies(PreparedScene scene) const {
    if (proxies() == 0) return scene;
    scene.corners = corners_.data();
    scene.triangles[0] += proxies();
    return scene;
}

std::int64_t SceneFeatures::points_below(std::int32_t vertex) const {
    if (!lists_points_) return vertex;
    return std::partition_point(points_.begin(), points_.end(), [&](std::int32_t v) { return v < vertex; }) -
           points_.begin();
}

// A slot is a side of a triangle, or an entry of the list (SceneFeatures::Side). The slots of one edge are in ascending
// order: first the sides of triangles, then the entries of the list. The first triangle owns the first entry.
void SceneFeatures::find_owners_of_edges(ParallelFor& workers) {
    const auto sides = static_cast<std::int32_t>(3 * faces_);
    owner_.resize_discard(edges_.size());
    for (TriangleEdges& edges : edges_of_) edges.fill(-1);
    workers.parallel_for(count_.size() - 1, [&](std::size_t c) {
        for_each_edge_of(c, [&](std::int32_t, const Side* begin, const Side* end) {
            const std::int32_t slot = begin->slot, face = slot < sides ? slot / 3 : -1;
            const Side* listed = std::find_if(begin, end, [&](const Side& s) { return s.slot >= sides; });
            for (const Side* s = listed; s != end; ++s) owner_[s->slot - sides] = face;
            if (face < 0 || listed == end) return;
            owner_[listed->slot - sides] = owned_by_triangle;
            edges_of_[face][static_cast<std::size_t>(slot % 3)] = listed->slot - sides;
            // Atomic, since another thread may set the bit of another side of this triangle.
            std::atomic_ref(owned_[face]).fetch_or(static_cast<std::uint8_t>(8 << slot % 3), std::memory_order_relaxed);
        });
    });
}

void SceneFeatures::add_proxy(const std::array<std::int32_t, 3>& corners, std::uint8_t owned, std::int32_t face) {
    for (const std::int32_t v : corners) corners_.push_back(v);
    owned_.push_back(owned);
    face_of_proxy_.push_back(face);
}

void SceneFeatures::add_proxies_of_edges() {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const std::int32_t face = owner_[e];
        if (face == owned_by_triangle) continue;
        const bool lone = face < 0;
        lone_edges_ = lone_edges_ || lone;
        add_proxy({edges_[e].a, edges_[e].b, edges_[e].b}, static_cast<std::uint8_t>(8 | (lone ? lone_edge : 0)), face);
        edges_of_.push_back({static_cast<std::int32_t>(e), -1, -1});
    }
}

// The first listed point at a vertex is owned by the first triangle or proxy triangle that has the vertex, if there is
// one. All other points in the list get proxy triangles.
void SceneFeatures::add_proxies_of_points() {
    first_point_.assign(owner_.size(), -1);
    const auto n = static_cast<std::int32_t>(points_.size());
    bool as_vertices = true;
    for (std::int32_t p = n - 1; p >= 0; --p) {
        first_point_[points_[p]] = p;
        as_vertices = as_vertices && points_[p] == p;
    }
    const auto all = static_cast<std::int64_t>(owned_.size());
    if (!as_vertices) points_of_.assign(static_cast<std::size_t>(all), {-1, -1, -1});
    for (std::int64_t t = 0; t < all; ++t)
        for (int k = 0; k < 3; ++k) {
            const std::int32_t v = corners_[3 * t + k], point = first_point_[v];
            const bool earlier = (k > 0 && corners_[3 * t] == v) || (k > 1 && corners_[3 * t + 1] == v);
            if (owner_[v] != t || point < 0 || earlier) continue;
            owned_[t] = static_cast<std::uint8_t>(owned_[t] | 1 << k);
            if (!as_vertices) points_of_[t][static_cast<std::size_t>(k)] = point;
        }
    for (std::int32_t p = 0; p < n; ++p) {
        const std::int32_t v = points_[p], owner = owner_[v];
        if (owner >= 0 && first_point_[v] == p) continue;
        add_proxy({v, v, v}, static_cast<std::uint8_t>(1 | (owner < 0 ? lone_point : 0)), owner < faces_ ? owner : -1);
        edges_of_.push_back({-1, -1, -1});
        if (!as_vertices) points_of_.push_back({p, -1, -1});
    }
}

// Two other ends per vertex suffice for has_edge_apart(): an edge of a vertex is apart from a lone edge (one that no
// triangle has) if the edge's other end is not on the lone edge. Two different other ends may both be on the lone edge,
// but of three, at least one is not.
void SceneFeatures::find_adjacent() {
    neighbours_.clear();
    if (!lone_edges_) return;
    neighbours_.assign(static_cast<std::size_t>(vertices_), {});
    const auto add = [&](std::int32_t vertex, std::int32_t other) {
        Neighbours& of = neighbours_[vertex];
        if (of.first < 0 || of.first == other)
            of.first = other;
        else if (of.second < 0 || of.second == other)
            of.second = other;
        else
            of.more = true;
    };
    for (const Edge& e : edges_) {
        add(e.a, name(e.b));
        add(e.b, name(e.a));
    }
}

}  // namespace crumple
