#include "scene/closed_surface.h"

#include <algorithm>

namespace crumple {

ClosedSurface::ClosedSurface(MemoryMeter* meter)
    : features_(meter),
      place_(meter),
      vertex_at_place_(meter),
      end_of_(meter),
      components_(meter),
      faces_(meter),
      first_face_(meter),
      down_(meter),
      sum_(meter),
      first_(meter),
      neighbour_(meter),
      parent_(meter),
      next_(meter) {}

void ClosedSurface::release() {
    features_.release();
    revision_ = 0;
    for (auto* array : {&place_, &vertex_at_place_, &end_of_, &components_, &faces_, &first_face_, &sum_, &first_,
                        &neighbour_, &parent_, &next_})
        array->release();
    down_.release();
}

void ClosedSurface::prepare(const PreparedScene& scene, ParallelFor& workers) {
    features_.prepare(scene, false, workers);
    if (features_.revision() == revision_) return;
    revision_ = 0;  // invalid if memory runs out half-way
    check_closed();
    parent_.assign(static_cast<std::size_t>(scene.vertex_count()), -2);
    walk();
    mark_edges();
    sort_faces();
    revision_ = features_.revision();
}

/// Returns 1 if the triangle names an edge from its lower to its higher vertex, −1 for the opposite direction, 0 if
/// both ends are equal.
std::int32_t ClosedSurface::direction(std::int32_t triangle, std::size_t edge) const {
    const std::int32_t* c = corners(triangle);
    const std::int32_t from = c[edge], to = c[(edge + 1) % 3];
    return (from < to) - (to < from);
}

void ClosedSurface::check_closed() {
    sum_.assign(features_.edges().size(), 0);
    for (std::int32_t t = 0; t < features_.faces(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            if (const std::int32_t edge = features_.edges_of(t)[k]; edge >= 0) sum_[edge] += direction(t, k);
    closed_ = std::all_of(sum_.begin(), sum_.end(), [](std::int32_t sum) { return sum == 0; });
}

Array<OpenEdge> ClosedSurface::open_edges() const {
    Array<OpenEdge> open;
    for (std::size_t e = 0; e < sum_.size(); ++e)
        if (sum_[e] != 0) open.push_back({features_.edges()[e], -1});
    const auto before = [](const OpenEdge& x, const Edge& y) { return x.edge < y; };
    for (std::int32_t t = 0; t < features_.faces(); ++t)
        for (const std::int32_t e : features_.edges_of(t)) {
            if (e < 0 || sum_[e] == 0) continue;
            OpenEdge& found = *std::lower_bound(open.begin(), open.end(), features_.edges()[e], before);
            if (found.triangle < 0) found.triangle = t;
        }
    return open;
}

// Orders vertices by a depth-first walk of each component, without recursion.
void ClosedSurface::walk() {
    const auto vertices = static_cast<std::int32_t>(parent_.size());
    first_.assign(static_cast<std::size_t>(vertices) + 2, 0);
    for (const Edge& edge : features_.edges()) ++first_[edge.a + 2], ++first_[edge.b + 2];
    for (std::int32_t v = 0; v < vertices; ++v) first_[v + 2] += first_[v + 1];
    neighbour_.resize_discard(2 * features_.edges().size());
    for (const Edge& edge : features_.edges()) {
        neighbour_[first_[edge.a + 1]++] = edge.b;
        neighbour_[first_[edge.b + 1]++] = edge.a;
    }
    // Now the vertices adjacent to v are entries [first_[v], first_[v + 1]) of neighbour_. next_[v] is the entry that
    // the walk follows next.
    place_.assign(static_cast<std::size_t>(vertices), -1);
    vertex_at_place_.clear();
    end_of_.clear();
    components_.clear();
    next_.resize_discard(static_cast<std::size_t>(vertices));
    std::copy_n(first_.data(), static_cast<std::size_t>(vertices), next_.data());
    const auto meet = [&](std::int32_t v, std::int32_t from) {
        parent_[v] = from;
        place_[v] = places();
        vertex_at_place_.push_back(v);
        end_of_.push_back(0);
    };
    for (std::int32_t root = 0; root < vertices; ++root) {
        if (parent_[root] != -2 || first_[root] == first_[root + 1]) continue;
        components_.push_back(places());
        meet(root, -1);
        for (std::int32_t v = root; v >= 0;) {
            while (next_[v] < first_[v + 1] && parent_[neighbour_[next_[v]]] != -2) ++next_[v];
            if (next_[v] < first_[v + 1]) {
                const std::int32_t below = neighbour_[next_[v]++];
                meet(below, v);
                v = below;
            } else {
                end_of_[place_[v]] = places();
                v = parent_[v];
            }
        }
    }
    components_.push_back(places());
}

void ClosedSurface::mark_edges() {
    down_.assign(static_cast<std::size_t>(features_.faces()), 0);
    for (std::int32_t t = 0; t < features_.faces(); ++t) {
        const std::int32_t* c = corners(t);
        for (std::size_t k = 0; k < 3; ++k) {
            if (!(features_.owned(t) >> (3 + k) & 1)) continue;
            const std::int32_t from = c[k], to = c[(k + 1) % 3];
            if (parent_[to] == from) down_[t] = static_cast<std::uint8_t>(down_[t] | 1 << k);
            if (parent_[from] == to) down_[t] = static_cast<std::uint8_t>(down_[t] | 8 << k);
        }
    }
}

void ClosedSurface::sort_faces() {
    first_face_.assign(static_cast<std::size_t>(places()) + 1, 0);
    const auto faces = static_cast<std::int32_t>(features_.faces());
    for (std::int32_t t = 0; t < faces; ++t)
        if (place_[corners(t)[0]] >= 0) ++first_face_[place_[corners(t)[0]] + 1];
    for (std::int32_t p = 0; p < places(); ++p) first_face_[p + 1] += first_face_[p];
    faces_.resize_discard(static_cast<std::size_t>(first_face_.back()));
    next_.resize_discard(static_cast<std::size_t>(places()));
    std::copy_n(first_face_.data(), static_cast<std::size_t>(places()), next_.data());
    for (std::int32_t t = 0; t < faces; ++t)
        if (const std::int32_t p = place_[corners(t)[0]]; p >= 0) faces_[next_[p]++] = t;
}

}  // namespace crumple
