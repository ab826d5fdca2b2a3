#pragma once

// Vertices and edges of a scene, each once, with the triangle that owns it, and proxy triangles for features that no
// triangle can own.
//
// A feature is owned by the lowest triangle that names it. A pair of features is tested if the sweep reports the pair
// of their owners. So each pair is tested once, and the triangles' hulls, which contain their features, decide whether
// it has to be. Faces own themselves.
//
//   triangle t: corners c0 c1 c2, edges e0 = c0 c1, e1 = c1 c2, e2 = c2 c0
//   owned[t]:   bit k: the vertex at corner k;  bit 3 + k: edge k;  lone_point, lone_edge: see feature_table.h
//
// If the caller lists edges or points, these are the features. A listed edge or point that no triangle names has a
// *proxy triangle*: a degenerate triangle (a, b, b) for an edge, (v, v, v) for a point. It comes after the scene's
// triangles, owns that feature, and is not a face. Each repetition of an edge or a point in the list has a proxy
// triangle, too, even if a triangle names the feature (proxies.cpp).

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

/// Edges and points that the caller lists, as vertices of the scene; validated.
struct CodimensionalFeatures {
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};
};

class SceneFeatures {
   public:
    explicit SceneFeatures(MemoryMeter* meter);

    /// Finds the features of the scene's triangles, or those listed. Results are cached while corners and lists stay
    /// the same; then the cost is a comparison, else O(triangles, edges, points), mostly on all threads. `weld`:
    /// vertices with equal positions, at the start and at the end, count as one for incident().
    void prepare(const PreparedScene& scene, bool weld, ParallelFor& workers, const CodimensionalFeatures& listed = {});

    /// True if prepare(), without welding, was last called for the same numbers of vertices, triangles, codimensional
    /// edges and codimensional points.
    bool has_counts_of(const Shape& shape) const {
        const auto listed = [](bool lists, const auto& mine, const auto& theirs) {
            return lists == theirs.has_value() && (!lists || mine.size() == theirs->size());
        };
        return !is_copied_ && !is_welded() && vertices_ == shape.vertices.rows && faces_ == shape.triangles.rows &&
               listed(lists_edges_, edges_, shape.edges) && listed(lists_points_, points_, shape.points);
    }

    /// Copies the features of a validated part; replaces prepare().
    void adopt(const Part& part);

    /// Edges are identified by their index in edges(). edges_of() and owned() take triangles and proxy triangles.
    const Array<Edge>& edges() const { return edges_; }
    const TriangleEdges& edges_of(std::int64_t triangle) const { return edges_of_[triangle]; }
    std::uint8_t owned(std::int64_t triangle) const { return owned_[triangle]; }

    bool lists_edges() const { return lists_edges_; }
    /// If points are not listed, a point's index is its vertex; else its position in the list.
    bool lists_points() const { return lists_points_; }
    std::int64_t points() const { return lists_points_ ? static_cast<std::int64_t>(points_.size()) : vertices_; }
    std::int32_t vertex_of(std::int32_t point) const { return lists_points_ ? points_[point] : point; }
    /// Returns the number of points with vertices below this one. The list must be ordered at this vertex: points of
    /// lower vertices first, as the points of consecutive bodies are.
    std::int64_t points_below(std::int32_t vertex) const;
    /// Returns the point of the vertex that a triangle or a proxy triangle owns at a corner.
    std::int32_t point_of(std::int64_t triangle, int corner) const { return table().point_of(triangle, corner); }

    /// Number of triangles of the scene; proxy triangles are numbered from there on.
    std::int64_t faces() const { return faces_; }
    std::int64_t proxies() const { return static_cast<std::int64_t>(face_of_carrier_.size()); }
    /// Returns the lowest triangle that names the feature of proxy triangle i; -1 if none does.
    std::int32_t face_of_proxy(std::int64_t i) const { return face_of_carrier_[i]; }
    /// True if features need no special treatment: triangles own all of them, without proxy triangles, and points have
    /// the indices of their vertices.
    bool plain() const { return proxies() == 0 && points_of_.empty(); }
    /// Corners of all triangles and proxy triangles.
    const std::int32_t* corners() const { return corners_.data(); }
    PreparedScene with_proxies(PreparedScene scene) const;

    /// True if vertices have representatives other than themselves (see name()), because they are welded.
    bool is_welded() const { return !names_.empty(); }
    const Array<std::int32_t>& names() const { return names_; }  ///< representative of each vertex; empty: itself
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
    /// The codimensional points, as vertices; empty: points are vertices.
    const Array<std::int32_t>& codimensional_points() const { return points_; }
    const Array<PointsOfTriangle>& points_of() const { return points_of_; }
    /// Changes whenever the features change.
    std::uint64_t revision() const { return revision_; }

    /// Frees all memory.
    void release();

    using Neighbours = NamedNeighbours;
    bool has_lone_edges() const { return !neighbours_.empty(); }
    const Neighbours& neighbours(std::int32_t vertex) const { return neighbours_[vertex]; }

   private:
    struct Side {
        std::int32_t other;  ///< the higher vertex
        std::int32_t slot;   ///< 3 * triangle + side; codimensional edges follow after all sides
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

    static constexpr std::int64_t chunk = 4096;  ///< lower vertices per chunk
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
    Array<std::int32_t> names_, corners_;  ///< corners_: cache key of all other members
    std::int64_t vertices_ = -1, faces_ = 0;
    std::uint64_t revision_ = 0;
    bool lists_edges_ = false, lists_points_ = false, lone_edges_ = false, is_copied_ = false;
    Array<std::int32_t> points_;         ///< points as listed, by vertex
    Array<PointsOfTriangle> points_of_;  ///< per triangle, by corner; empty: points are vertices
    Array<std::int32_t> face_of_carrier_;
    Array<Neighbours> neighbours_;  ///< per vertex, if there are lone edges
    // Scratch:
    Array<Side> side_;
    Array<std::int64_t> first_;        ///< first side of each lower vertex
    Array<std::int64_t> count_;        ///< number of edges of each chunk of lower vertices
    Array<std::int32_t> owner_;        ///< owner of each vertex, or of each listed edge
    Array<std::int32_t> first_point_;  ///< first position of each vertex in the list of points
    SceneBuffers buffers_;
};

}  // namespace crumple
