#pragma once

// Vertices and edges of a scene, each once, and who owns it; and carriers for those that no triangle can own.
//
// A feature is owned by the lowest triangle that names it. A pair of features is tested where the triangles that own
// them are a pair of the sweep; so it is tested once, and the triangles' hulls, which hold their features, decide
// whether it has to be. Faces own themselves.
//
//   triangle t: corners c0 c1 c2, edges e0 = c0 c1, e1 = c1 c2, e2 = c2 c0
//   owned[t]:   bit k: the vertex at corner k;  bit 3 + k: edge k;  lone_point, lone_edge: see there
//
// Callers may list edges and points, which are the features then. What they list and no triangle names has a *carrier*:
// a degenerate triangle (a, b, b) of an edge, (v, v, v) of a point, which comes behind the scene's triangles, owns that
// feature, and is no face. An edge or a point that is listed once more has one, too, whatever names it (carriers.cpp).

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

/// Edges and points that a caller lists, by the scene's vertices, checked.
struct ListedFeatures {
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};
};

class SceneFeatures {
   public:
    explicit SceneFeatures(MemoryMeter* meter);

    /// Of the scene's triangles, and what is listed. What is known is kept while corners and lists stay the same: then
    /// it costs a comparison; else O(triangles, edges, points), mostly on all threads. `weld`: vertices at equal
    /// positions, at the start and at the end, count as one for incident().
    void prepare(const PreparedScene& scene, bool weld, ParallelFor& workers, const ListedFeatures& listed = {});

    /// Whether prepare() has made this of as many vertices, triangles, and listed edges and points, without welding.
    bool has_counts_of(const Shape& shape) const {
        const auto listed = [](bool lists, const auto& mine, const auto& theirs) {
            return lists == theirs.has_value() && (!lists || mine.size() == theirs->size());
        };
        return !adopted_ && !renames() && vertices_ == shape.vertices.rows && faces_ == shape.triangles.rows &&
               listed(lists_edges_, edges_, shape.edges) && listed(lists_points_, points_, shape.points);
    }

    /// What a part that was checked says of its triangles and carriers, in place of prepare().
    void adopt(const Part& part);

    /// Of each triangle and each carrier; edges are by their place in edges().
    const Array<Edge>& edges() const { return edges_; }
    const TriangleEdges& edges_of(std::int64_t triangle) const { return edges_of_[triangle]; }
    std::uint8_t owned(std::int64_t triangle) const { return owned_[triangle]; }

    bool lists_edges() const { return lists_edges_; }
    /// Points have the indices of vertices unless they are listed: then those of the list.
    bool lists_points() const { return lists_points_; }
    std::int64_t points() const { return lists_points_ ? static_cast<std::int64_t>(points_.size()) : vertices_; }
    std::int32_t vertex_of(std::int32_t point) const { return lists_points_ ? points_[point] : point; }
    /// How many points have vertices below this one, where those of lower vertices come first, as bodies' do.
    std::int64_t points_below(std::int32_t vertex) const;
    /// Of the vertex that a triangle or a carrier owns at a corner.
    std::int32_t point_of(std::int64_t triangle, int corner) const { return table().point_of(triangle, corner); }

    /// Triangles of the scene; carriers are numbered from there on.
    std::int64_t faces() const { return faces_; }
    std::int64_t carriers() const { return static_cast<std::int64_t>(face_of_carrier_.size()); }
    /// The lowest triangle that names what carrier i owns; -1 if none does.
    std::int32_t face_of_carrier(std::int64_t i) const { return face_of_carrier_[i]; }
    /// Tests of features are those of triangles alone.
    bool plain() const { return carriers() == 0 && points_of_.empty(); }
    /// Corners of all triangles and carriers, and the scene with these; but for groups, which others have to add.
    const std::int32_t* corners() const { return corners_.data(); }
    PreparedScene with_carriers(PreparedScene scene) const;

    /// What vertices are called where it is asked whether two are the same: mostly by their index.
    bool renames() const { return !names_.empty(); }
    const Array<std::int32_t>& names() const { return names_; }  ///< empty: their index
    std::int32_t name(std::int32_t vertex) const { return names_.empty() ? vertex : names_[vertex]; }
    /// Whether a face or an edge and a vertex, or two edges, have a vertex in common.
    bool incident(std::int32_t vertex, const std::int32_t* corners) const {
        const std::int32_t v = name(vertex);
        return v == name(corners[0]) || v == name(corners[1]) || v == name(corners[2]);
    }
    bool incident(std::int32_t vertex, const Edge& e) const { return table().incident(vertex, e); }
    bool incident(const Edge& e, const Edge& f) const { return incident(e.a, f) || incident(e.b, f); }
    /// Whether an edge of the vertex is a pair with a lone edge that it is not on: then that pair covers the vertex.
    bool has_edge_apart(std::int32_t vertex, const Edge& lone) const { return table().has_edge_apart(vertex, lone); }

    /// All of it that inner loops read, while this stays as it is.
    FeatureTable table() const {
        const auto any = [](const auto& array) { return array.empty() ? nullptr : array.data(); };
        return {edges_of_.data(), owned_.data(),    corners_.data(), any(names_),
                any(points_of_),  any(neighbours_), faces_};
    }
    /// The listed vertices; empty: points are vertices.
    const Array<std::int32_t>& listed_points() const { return points_; }
    const Array<PointsOfTriangle>& points_of() const { return points_of_; }
    /// Another number whenever what is known has changed.
    std::uint64_t revision() const { return revision_; }

    /// Gives all memory back.
    void release();

    using Neighbours = NamedNeighbours;
    bool knows_neighbours() const { return !neighbours_.empty(); }  ///< there are lone edges
    const Neighbours& neighbours(std::int32_t vertex) const { return neighbours_[vertex]; }

   private:
    struct Side {
        std::int32_t other;  ///< its greater vertex
        std::int32_t slot;   ///< 3 times its triangle, and which side of it; behind these listed edges
    };
    bool known(const PreparedScene& scene, const ListedFeatures& listed) const;
    void sort_sides(const PreparedScene& scene, ParallelFor& workers);
    void make_edges(ParallelFor& workers);
    void find_owners_of_edges(ParallelFor& workers);
    void find_owned_vertices(std::int64_t vertices);
    void add_carriers_of_edges();
    void add_carriers_of_points();
    void add_carrier(const std::array<std::int32_t, 3>& corners, std::uint8_t owned, std::int32_t face);
    void find_neighbours();

    static constexpr std::int64_t chunk = 4096;  ///< of lower vertices
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
    Array<std::int32_t> names_, corners_;  ///< corners: for which the rest is known
    std::int64_t vertices_ = -1, faces_ = 0;
    std::uint64_t revision_ = 0;
    bool lists_edges_ = false, lists_points_ = false, lone_edges_ = false, adopted_ = false;
    Array<std::int32_t> points_;         ///< as listed
    Array<PointsOfTriangle> points_of_;  ///< by corner; empty: as vertices
    Array<std::int32_t> face_of_carrier_;
    Array<Neighbours> neighbours_;  ///< of each vertex, if there are lone edges
    // Scratch:
    Array<Side> side_;
    Array<std::int64_t> first_;        ///< side of each lower vertex
    Array<std::int64_t> count_;        ///< edges of each chunk of lower vertices
    Array<std::int32_t> owner_;        ///< of each vertex, or of each listed edge
    Array<std::int32_t> first_point_;  ///< of each vertex: in the list
    SceneBuffers buffers_;
};

}  // namespace crumple
