#include "scene/scene_features.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "crumple/error.h"

namespace crumple {
namespace {

template <class T>
bool same(const Array<T>& mine, std::size_t size, const T* theirs) {
    return mine.size() >= size && (size == 0 || std::memcmp(mine.data(), theirs, size * sizeof(T)) == 0);
}
template <class T>
bool same(const Array<T>& mine, bool given, const std::optional<std::span<const T>>& theirs) {
    if (!given || !theirs) return given == theirs.has_value();
    return mine.size() == theirs->size() && same(mine, mine.size(), theirs->data());
}

void check_number(const PreparedScene& scene, const CodimensionalFeatures& listed) {
    const auto edges = static_cast<std::int64_t>(listed.edges ? listed.edges->size() : 0);
    const auto points = static_cast<std::int64_t>(listed.points ? listed.points->size() : 0);
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    if (scene.triangle_count() > most / 3)
        throw Error(ErrorCode::invalid_argument, "there are " + std::to_string(scene.triangle_count()) +
                                                     " triangles; queries about features support at most 715827882");
    if (edges + points > most - 3 * scene.triangle_count())
        throw Error(ErrorCode::invalid_argument,
                    "there are " + std::to_string(edges) + " edges and " + std::to_string(points) +
                        " points; together with three times the triangles, at most 2147483647 are supported");
}

}  // namespace

SceneFeatures::SceneFeatures(MemoryMeter* meter)
    : edges_(meter),
      edges_of_(meter),
      owned_(meter),
      names_(meter),
      corners_(meter),
      points_(meter),
      points_of_(meter),
      face_of_proxy_(meter),
      neighbours_(meter),
      side_(meter),
      first_(meter),
      count_(meter),
      owner_(meter),
      first_point_(meter),
      buffers_(meter) {}

void SceneFeatures::release() {
    edges_.release();
    edges_of_.release();
    owned_.release();
    names_.release();
    corners_.release();
    points_.release();
    points_of_.release();
    face_of_proxy_.release();
    neighbours_.release();
    side_.release();
    first_.release();
    count_.release();
    owner_.release();
    first_point_.release();
    buffers_.table.release();
    vertices_ = -1;
}

void SceneFeatures::prepare(const PreparedScene& scene, bool weld, ParallelFor& workers,
                            const CodimensionalFeatures& listed) {
    check_number(scene, listed);
    if (!known(scene, listed)) {
        vertices_ = -1;  // invalid if memory runs out half-way
        ++revision_;
        is_copied_ = false;
        faces_ = scene.triangle_count();
        corners_.resize_discard(static_cast<std::size_t>(3 * faces_));
        std::copy_n(scene.corners, corners_.size(), corners_.data());
        lists_edges_ = listed.edges.has_value();
        lists_points_ = listed.points.has_value();
        edges_.resize_discard(lists_edges_ ? listed.edges->size() : 0);
        points_.resize_discard(lists_points_ ? listed.points->size() : 0);
        if (lists_edges_) std::copy(listed.edges->begin(), listed.edges->end(), edges_.begin());
        if (lists_points_) std::copy(listed.points->begin(), listed.points->end(), points_.begin());
        edges_of_.resize_discard(static_cast<std::size_t>(faces_));
        owned_.assign(static_cast<std::size_t>(faces_), 0);
        face_of_proxy_.clear();
        points_of_.clear();
        lone_edges_ = false;
        sort_sides(scene, workers);
        if (lists_edges_) {
            find_owners_of_edges(workers);
            add_proxies_of_edges();
        } else {
            make_edges(workers);
        }
        find_owned_vertices(scene.vertex_count());
        if (lists_points_) add_proxies_of_points();
        vertices_ = scene.vertex_count();
    }
    if (weld || is_welded() || has_lone_edges()) ++revision_;  // representatives depend on positions, too
    names_.clear();
    if (weld) find_representatives(scene, buffers_.table, names_);
    find_adjacent();
}

bool SceneFeatures::known(const PreparedScene& scene, const CodimensionalFeatures& listed) const {
    return !is_copied_ && vertices_ == scene.vertex_count() && faces_ == scene.triangle_count() &&
           same(corners_, static_cast<std::size_t>(3 * faces_), scene.corners) &&
           same(edges_, lists_edges_, listed.edges) && same(points_, lists_points_, listed.points);
}

void SceneFeatures::copy_from(const Part& part) {
    const PartFeatures& given = *part.features;
    const auto copy = [](const auto& from, auto& to) {
        to.resize_discard(from.size());
        std::copy(from.begin(), from.end(), to.begin());
    };
    vertices_ = -1;
    ++revision_;
    is_copied_ = true;
    lone_edges_ = false;  // unused: neighbours_ is copied below
    copy(given.edge_ends, edges_);
    copy(given.edges_of, edges_of_);
    copy(given.owned, owned_);
    copy(given.names, names_);
    copy(part.mesh.corners, corners_);
    copy(given.point_vertices, points_);
    copy(given.points_of, points_of_);
    face_of_proxy_.assign(given.of_no_face.size(), -1);
    neighbours_.resize_discard(given.joined.size());
    for (std::size_t v = 0; v < given.joined.size(); ++v)
        neighbours_[v] = {given.joined[v][0], given.joined[v][1], given.joined[v][2] != 0};
    lists_points_ = given.lists_points;
    faces_ = given.faces;
    vertices_ = static_cast<std::int64_t>(given.vertices.size());
}

// Sorts all sides of triangles, followed by the codimensional edges, by their lower vertex (counting sort). Then sorts
// the entries of each vertex by the other end.
void SceneFeatures::sort_sides(const PreparedScene& scene, ParallelFor& workers) {
    const std::int64_t sides = 3 * faces_, vertices = scene.vertex_count();
    const std::int64_t slots = sides + static_cast<std::int64_t>(edges_.size());
    const auto ends = [&](std::int64_t slot) {
        const std::int64_t t = slot / 3 * 3;
        const Edge e = slot < sides ? Edge{corners_[t + slot % 3], corners_[t + (slot + 1) % 3]} : edges_[slot - sides];
        return std::pair(std::min(e.a, e.b), std::max(e.a, e.b));
    };
    first_.assign(static_cast<std::size_t>(vertices) + 2, 0);
    std::int64_t* next = first_.data() + 1;  // counts, then positions; finally first_[v] is v's first entry
    for (std::int64_t slot = 0; slot < slots; ++slot) {
        const auto [low, high] = ends(slot);
        if (low != high) ++next[low + 1];
    }
    for (std::int64_t v = 0; v < vertices; ++v) next[v + 1] += next[v];
    side_.resize_discard(static_cast<std::size_t>(next[vertices]));
    for (std::int64_t slot = 0; slot < slots; ++slot) {
        const auto [low, high] = ends(slot);
        if (low == high)
            edges_of_[slot / 3][static_cast<std::size_t>(slot % 3)] = -1;
        else
            side_[next[low]++] = {high, static_cast<std::int32_t>(slot)};
    }
    const auto chunks = static_cast<std::size_t>((vertices + chunk - 1) / chunk);
    count_.assign(chunks + 1, 0);
    workers.parallel_for(chunks, [&](std::size_t c) {
        const auto begin = static_cast<std::int64_t>(c) * chunk, end = std::min(vertices, begin + chunk);
        for (std::int64_t v = begin; v < end; ++v)
            std::sort(side_.data() + first_[v], side_.data() + first_[v + 1], [](const Side& s, const Side& t) {
                return std::pair(s.other, s.slot) < std::pair(t.other, t.slot);
            });
    });
}

void SceneFeatures::make_edges(ParallelFor& workers) {
    const std::size_t n = count_.size() - 1;
    workers.parallel_for(n, [&](std::size_t c) {
        std::int64_t edges = 0;
        for_each_edge_of(c, [&](std::int32_t, const Side*, const Side*) { ++edges; });
        count_[c + 1] = edges;
    });
    for (std::size_t c = 0; c < n; ++c) count_[c + 1] += count_[c];
    edges_.resize_discard(static_cast<std::size_t>(count_[n]));
    workers.parallel_for(n, [&](std::size_t c) {
        std::int64_t edge = count_[c];
        for_each_edge_of(c, [&](std::int32_t v, const Side* begin, const Side* end) {
            edges_[edge] = {v, begin->other};
            // Atomic, since another thread may set the bit of another side of this triangle.
            std::atomic_ref(owned_[begin->slot / 3])
                .fetch_or(static_cast<std::uint8_t>(8 << begin->slot % 3), std::memory_order_relaxed);
            for (const Side* s = begin; s != end; ++s)
                edges_of_[s->slot / 3][static_cast<std::size_t>(s->slot % 3)] = static_cast<std::int32_t>(edge);
            ++edge;
        });
    });
}

void SceneFeatures::find_owned_vertices(std::int64_t vertices) {
    const auto all = static_cast<std::int64_t>(owned_.size());
    owner_.assign(static_cast<std::size_t>(vertices), -1);
    for (std::int64_t t = 0; t < all; ++t)
        for (int k = 0; k < 3; ++k) {
            std::int32_t& owner = owner_[corners_[3 * t + k]];
            if (owner >= 0) continue;
            owner = static_cast<std::int32_t>(t);
            if (!lists_points_) owned_[t] = static_cast<std::uint8_t>(owned_[t] | 1 << k);
        }
}

}  // namespace crumple
