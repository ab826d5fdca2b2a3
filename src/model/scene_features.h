#pragma once

// Vertices and edges of a scene's triangles, each once, and who owns it.
//
// A feature is owned by the lowest triangle that names it. A pair of features is tested where the triangles that own
// them are a pair of the sweep; so it is tested once, and the triangles' hulls, which hold their features, decide
// whether it has to be. Faces own themselves.
//
//   triangle t: corners c0 c1 c2, edges e0 = c0 c1, e1 = c1 c2, e2 = c2 c0
//   owned[t]:   bit k: the vertex at corner k;  bit 3 + k: edge k

#include <array>
#include <cstdint>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/features.h"
#include "model/scene.h"

namespace crumple {

/// The edges of a triangle, by side; -1 where a side's ends are equal.
using TriangleEdges = std::array<std::int32_t, 3>;

class SceneFeatures {
   public:
    explicit SceneFeatures(MemoryMeter* meter);

    /// Of the scene's triangles. What is known is kept while their corners stay the same: then it costs a comparison;
    /// else O(triangles), on all threads. `weld`: vertices at equal positions, at the start and at the end, count as
    /// one for incident().
    void prepare(const Scene& scene, bool weld, ParallelFor& workers);

    const Array<Edge>& edges() const { return edges_; }
    const TriangleEdges& edges_of(std::int64_t triangle) const { return edges_of_[triangle]; }
    std::uint8_t owned(std::int64_t triangle) const { return owned_[triangle]; }

    /// What vertices are called where it is asked whether two are the same: mostly by their index.
    bool renames() const { return !names_.empty(); }
    std::int32_t name(std::int32_t vertex) const { return names_.empty() ? vertex : names_[vertex]; }
    /// Whether an edge and a vertex, or two edges, have a vertex in common.
    bool incident(std::int32_t vertex, const std::int32_t* corners) const {
        const std::int32_t v = name(vertex);
        return v == name(corners[0]) || v == name(corners[1]) || v == name(corners[2]);
    }
    bool incident(const Edge& e, const Edge& f) const {
        const std::int32_t a = name(e.a), b = name(e.b), c = name(f.a), d = name(f.b);
        return a == c || a == d || b == c || b == d;
    }

    /// Gives all memory back.
    void release();

   private:
    struct Side {
        std::int32_t other;  ///< its greater vertex
        std::int32_t slot;   ///< 3 times its triangle, and which side of it
    };

    bool known(const Scene& scene) const;
    void find_edges(const Scene& scene, ParallelFor& workers);
    void find_owned_vertices(const Scene& scene);

    Array<Edge> edges_;
    Array<TriangleEdges> edges_of_;
    Array<std::uint8_t> owned_;
    Array<std::int32_t> names_, corners_;  ///< corners: for which the rest is known
    std::int64_t vertices_ = -1;
    // Scratch:
    Array<Side> side_;
    Array<std::int64_t> first_;  ///< side of each lower vertex
    Array<std::int64_t> count_;  ///< edges of each chunk of lower vertices
    SceneBuffers buffers_;
};

}  // namespace crumple
