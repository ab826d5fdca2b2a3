#pragma once

// Rings of each vertex: the vertices that a path of at most `rings` edges leads to, by ascending index. Welded vertices
// are identified by their representatives (SceneFeatures::name). The relation is symmetric. Edges are the sides of all
// triangles, and the edges that the caller lists.

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "crumple/array.h"
#include "scene/scene_features.h"

namespace crumple {

class VertexRings {
   public:
    explicit VertexRings(MemoryMeter* meter)
        : of_(meter), first_(meter), next_(meter), first_next_(meter), corners_(meter), names_(meter) {}

    /// Finds the rings on all threads. `vertices`: number of vertices of the scene that `features` was made from. The
    /// result is cached while corners, representatives and `rings` stay the same; then the cost is a comparison. Else
    /// the cost is that of two walks per vertex: O(v r d log(r d)) for v vertices, with r vertices in the rings of each
    /// and d edges per vertex. Memory: 4 bytes for each of the v r entries, and about 100 per vertex.
    void prepare(const SceneFeatures& features, std::int64_t vertices, std::int32_t rings, ParallelFor& workers,
                 Cancellation& cancellation);

    /// Copies the rings of a validated part (crumple/part.h), instead of prepare().
    void copy_from(const PartFeatures& part);

    std::int32_t rings() const { return rings_; }
    /// Returns the vertices in the rings of a representative vertex, without the vertex itself.
    std::span<const std::int32_t> about(std::int32_t name) const {
        return {of_.data() + first_[name], static_cast<std::size_t>(first_[name + 1] - first_[name])};
    }
    /// True if a path of at most rings() edges connects two representative vertices; false for a vertex and itself.
    bool joined(std::int32_t name, std::int32_t other) const {
        const auto ring = about(name);
        return std::binary_search(ring.begin(), ring.end(), other);
    }

    /// Data of about(): all rings, one after another, and the start of each vertex's ring.
    std::span<const std::int32_t> rings_of_all() const { return of_.span(); }
    std::span<const std::int64_t> firsts() const { return first_.span(); }
    /// Changes whenever the rings change; unique in the process.
    std::uint64_t revision() const { return revision_; }

    /// Frees all memory.
    void release();

   private:
    bool known(const SceneFeatures& features, std::int64_t vertices, std::int32_t rings) const;
    void find_next(const SceneFeatures& features, std::int64_t vertices);
    void walk(std::int32_t from, Array<std::int32_t>& reached) const;

    Array<std::int32_t> of_;     ///< all rings, one after another
    Array<std::int64_t> first_;  ///< start of each vertex's ring, and the end
    Array<std::int32_t> next_;   ///< adjacent vertices of each vertex, one vertex after another
    Array<std::int64_t> first_next_;
    Array<std::int32_t> corners_, names_;  ///< those for which the rings were found; compared by known()
    std::int64_t vertices_ = -1;
    std::int32_t rings_ = 0;
    std::uint64_t revision_ = 0;
};

}  // namespace crumple
