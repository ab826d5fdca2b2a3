#pragma once

// The rings about each vertex: which vertices a path of at most so many edges leads to, in ascending order, by the
// names that vertices have where two are compared. Of every pair, each lists the other. Edges are those of all
// triangles, and those that are listed.

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

    /// `vertices`: of the scene that the features are of. What is known is kept while corners, names and `rings` stay
    /// the same: then it costs a comparison. Else, on all threads, a walk about each vertex: O(v r d log(r d)) for v
    /// vertices, r of them within so many edges, and d edges at each. Keeps 4 bytes for each of the v r, and some 100 a
    /// vertex.
    void prepare(const SceneFeatures& features, std::int64_t vertices, std::int32_t rings, ParallelFor& workers,
                 Cancellation& cancellation);

    /// Those that a part knows, checked, in place of prepare().
    void adopt(const PartFeatures& part);

    std::int32_t rings() const { return rings_; }
    /// The others within so many edges of a name.
    std::span<const std::int32_t> about(std::int32_t name) const {
        return {of_.data() + first_[name], static_cast<std::size_t>(first_[name + 1] - first_[name])};
    }
    /// Whether a path leads from one to the other; not of a name and itself.
    bool joined(std::int32_t name, std::int32_t other) const {
        const auto ring = about(name);
        return std::binary_search(ring.begin(), ring.end(), other);
    }

    /// What about() reads: the rings of all, one after the other, and where those of each name begin.
    std::span<const std::int32_t> rings_of_all() const { return of_.span(); }
    std::span<const std::int64_t> firsts() const { return first_.span(); }
    /// Another number whenever what is known has changed; no two have the same.
    std::uint64_t revision() const { return revision_; }

    /// Gives all memory back.
    void release();

   private:
    bool known(const SceneFeatures& features, std::int64_t vertices, std::int32_t rings) const;
    void find_next(const SceneFeatures& features, std::int64_t vertices);
    void walk(std::int32_t from, Array<std::int32_t>& reached) const;

    Array<std::int32_t> of_;     ///< the rings of all, one after the other
    Array<std::int64_t> first_;  ///< where those of each vertex begin; and the end
    Array<std::int32_t> next_;   ///< by vertex, where its edges lead
    Array<std::int64_t> first_next_;
    Array<std::int32_t> corners_, names_;  ///< for which this is known
    std::int64_t vertices_ = -1;
    std::int32_t rings_ = 0;
    std::uint64_t revision_ = 0;
};

}  // namespace crumple
