#pragma once

// Vertices and edges of a scene, each once, with the triangle that owns it, and proxy triangles for features that no
// triangle can own.
//
// A triangle *names* its three corners and the edges between them. A feature is owned by the lowest triangle that names
// it; a face owns itself. A pair of features is tested if the sweep reports the pair of the owning triangles. So each
// pair of features is tested at most once, and only if the bounding volumes of the owners, which contain the features,
// are close enough.
//
//   triangle t: corners c0 c1 c2, edges e0 = c0 c1, e1 = c1 c2, e2 = c2 c0
//   owned[t]:   bit k: the vertex at corner k;  bit 3 + k: edge k;  lone_point, lone_edge: see feature_table.h
//
// If the caller lists edges or points (codimensional features), these replace the edges or the vertices of the
// triangles. A listed edge that no triangle names has a *proxy triangle*: a degenerate triangle (a, b, b), which comes
// after the scene's triangles, owns the edge, and is not a face. A listed point whose vertex belongs to no triangle and
// no such edge has a proxy triangle (v, v, v). So has each repetition of an edge or a point in its list, even if a
// triangle names the feature (proxies.cpp).

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/features.h"
#include "crumple/part.h"
#include "crumple/world.h"
#include "scene/feature_table.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Edges and points that the caller lists, as indices of the scene's vertices; validated. Without a value, there is no
/// list.
struct CodimensionalFeatures {
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};
};

class SceneFeatures {
   public:
    explicit SceneFeatures(MemoryMeter* meter);

    /// Finds the edges and vertices of the scene's triangles, or those that are listed, and their owners. Results are
    /// cached while the corners and the lists stay the same; then the cost is a comparison, else O(triangles + edges +
    /// points), mostly on all threads. `weld`: vertices with equal positions, at the start and at the end, count as one
    /// for incident().
    void prepare(const PreparedScene& scene, bool weld, ParallelFor& workers, const CodimensionalFeatures& listed = {});

    /// True if prepare() was last called without welding, for the same numbers of vertices, triangles, codimensional
    /// edges and codimensional points as `shape` has.
    bool has_counts_of(const Shape& shape) const {
        const auto listed = [](bool lists, const auto& mine, const auto& theirs) {
            return lists == theirs.has_value() && (!lists || mine.size() == theirs->size());
        };
        return !is_copied_ && !is_welded() && vertices_ == shape.vertices.rows && faces_ == shape.triangles.rows &&
               listed(lists_edges_, edges_, shape.edges) && listed(lists_points_, points_, shape.points);
    }

    /// Copies the features of a validated part (crumple/part.h), instead of prepare().
    void copy_from(const Part& part);

    /// Edges are identified by their index in edges(). edges_of() and owned() accept the indices of triangles and of
    /// proxy triangles.
    const Array<Edge>& edges() const { return edges_; }
    const TriangleEdges& edges_of(std::int64_t triangle) const { return edges_of_[triangle]; }
    std::uint8_t owned(std::int64_t triangle) const { return owned_[triangle]; }

    bool lists_edges() const { return lists_edges_; }
    /// True if the caller lists points. Then the index of a point is its position in the list; else it is its vertex.
    bool lists_points() const { return lists_points_; }
    std::int64_t points() const { return lists_points_ ? static_cast<std::int64_t>(points_.size()) : vertices_; }
    std::int32_t vertex_of(std::int32_t point) const { return lists_points_ ? points_[point] : point; }
    /// Returns the number of points whose vertices are below this one. In the list, the points of lower vertices must
    /// come before all others, as they do if this is the first vertex of a body.
    std::int64_t points_below(std::int32_t vertex) const;
    /// Returns the index of the point that a triangle or a proxy triangle owns at a corner.
    std::int32_t point_of(std::int64_t triangle, int corner) const { return table().point_of(triangle, corner); }

    /// Number of triangles of the scene; proxy triangles are numbered from there on.
    std::int64_t faces() const { return faces_; }
    std::int64_t proxies() const { return static_cast<std::int64_t>(face_of_proxy_.size()); }
    /// Returns the lowest triangle that names the feature of proxy triangle i; -1 if none does.
    std::int32_t face_of_proxy(std::int64_t i) const { return face_of_proxy_[i]; }
    /// True if features need no special treatment: triangles own all of them, without proxy triangles, and points have
    /// the indices of their vertices.
    bool plain() const { return proxies() == 0 && points_of_.empty(); }
    /// Corners of all triangles and proxy triangles.
    const std::int32_t* corners() const { return corners_.data(); }
    PreparedScene with_proxies(PreparedScene scene) const;

    /// True if vertices are welded. name() then returns the representative of a vertex, which may be another vertex at
    /// the same position.
    bool is_welded() const { return !names_.empty(); }
    const Array<std::int32_t>& names() const { return names_; }  ///< representative of each vertex; empty if not welded
    std::int32_t name(std::int32_t vertex) const { return names_.empty() ? vertex : names_[vertex]; }
    /// incident(): true if a vertex and a face, a vertex and an edge, or two edges have a common vertex.
    bool incident(std::int32_t vertex, const std::int32_t* corners) const {
        const std::int32_t v = name(vertex);
        return v == name(corners[0]) || v == name(corners[1]) || v == name(corners[2]);
    }
    bool incident(std::int32_t vertex, const Edge& e) const { return table().incident(vertex, e); }
    bool incident(const Edge& e, const Edge& f) const { return incident(e.a, f) || incident(e.b, f); }
    /// True if some edge of `vertex` has no common vertex with `lone`. Then the pair of these two edges makes a test of
    /// `vertex` against `lone` unnecessary. `vertex` must not be an end of `lone`.
    bool has_edge_apart(std::int32_t vertex, const Edge& lone) const { return table().has_edge_apart(vertex, lone); }

    /// Returns pointers to all data for inner loops; valid while this object is unchanged.
    FeatureTable table() const {
        const auto any = [](const auto& array) { return array.empty() ? nullptr : array.data(); };
        return {edges_of_.data(), owned_.data(),    corners_.data(), any(names_),
                any(points_of_),  any(neighbours_), faces_};
    }
    /// Vertices of the codimensional points, if lists_points(); else empty.
    const Array<std::int32_t>& codimensional_points() const { return points_; }
    const Array<PointsOfTriangle>& points_of() const { return points_of_; }
    /// Changes whenever the features change.
    std::uint64_t revision() const { return revision_; }

    /// Frees all memory.
    void release();

    using Neighbours = AdjacentVertices;
    bool has_lone_edges() const { return !neighbours_.empty(); }
    const Neighbours& neighbours(std::int32_t vertex) const { return neighbours_[vertex]; }

   private:
    struct Side {
        std::int32_t other;  ///< higher vertex of the side
        std::int32_t slot;   ///< 3 * triangle + side (0 to 2); the slots of codimensional edges follow
    };
    bool known(const PreparedScene& scene, const CodimensionalFeatures& listed) const;
    void sort_sides(const PreparedScene& scene, ParallelFor& workers);
    void make_edges(ParallelFor& workers);
    void find_owners_of_edges(ParallelFor& workers);
    void find_owned_vertices(std::int64_t vertices);
    void add_proxies_of_edges();
    void add_proxies_of_points();
    void add_proxy(const std::array<std::int32_t, 3>& corners, std::uint8_t owned, std::int32_t face);
    void find_adjacent();

    static constexpr std::int64_t chunk = 4096;  ///< vertices per chunk; an edge is in the chunk of its lower vertex
    /// Calls visit(v, begin, end) with the sides of each edge whose lower vertex v is in the chunk.
    template <class Visit>
    void for_each_edge_of(std::size_t c, Visit visit) {
        const auto vertices = static_cast<std::int64_t>(first_.size()) - 2;
        const auto first = static_cast<std::int64_t>(c) * chunk, last = std::min(vertices, first + chunk);
        for (std::int64_t v = first; v < last; ++v) {
            const Side *begin = side_.data() + first_[v], *end = side_.data() + first_[v + 1];
            while (begin != end) {
                const Side* next = begin + 1;
                while (next != end && next->other == begin->other) ++next;
                visit(static_cast<std::int32_t>(v), begin, next);
                begin = next;
            }
        }
    }

    Array<Edge> edges_;
    Array<TriangleEdges> edges_of_;
    Array<std::uint8_t> owned_;
    /// Representative of each vertex, and corners of triangles and proxy triangles. prepare() compares the corners of
    /// the triangles, and the edges and points if they are listed, to find out if its results are still valid.
    Array<std::int32_t> names_, corners_;
    std::int64_t vertices_ = -1, faces_ = 0;
    std::uint64_t revision_ = 0;
    bool lists_edges_ = false, lists_points_ = false, lone_edges_ = false, is_copied_ = false;
    Array<std::int32_t> points_;         ///< vertices of the codimensional points
    Array<PointsOfTriangle> points_of_;  ///< by triangle and proxy triangle; empty: a point's index is its vertex
    Array<std::int32_t> face_of_proxy_;
    Array<Neighbours> neighbours_;  ///< by vertex, if there are edges that no triangle has; else empty
    // Scratch:
    Array<Side> side_;
    Array<std::int64_t> first_;  ///< by lower vertex: its first entry of side_
    Array<std::int64_t> count_;  ///< number of edges of each chunk of lower vertices
    /// First by listed edge: the lowest triangle that names it, or -1, or a mark (proxies.cpp). Then by vertex: the
    /// lowest triangle or proxy triangle that has it, or -1.
    Array<std::int32_t> owner_;
    Array<std::int32_t> first_point_;  ///< first position of each vertex in the list of points
    SceneBuffers buffers_;
};

}  // namespace crumple
