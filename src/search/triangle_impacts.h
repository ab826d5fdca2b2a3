#pragma once

// Pairs of triangles of a step: those that intersect at its start, and those of whose features some pair touches. The
// same for all backends: they find both, and what follows for triangles is counted and put into rows.

#include <cstdint>
#include <span>

#include "backends/backend.h"
#include "crumple/array.h"
#include "queries/feature_request.h"
#include "scene/prepared_scene.h"
#include "scene/rules.h"
#include "scene/scene_features.h"

namespace crumple {

class TriangleImpacts {
   public:
    explicit TriangleImpacts(MemoryMeter& meter);

    /// Whether some pair intersects at the start. `scene`: with the carriers of `features`.
    bool any_at_start(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features);

    /// Makes rows() of all impacts of features, and of the pairs that intersect at the start: unique, in order; the
    /// value is the first time, the flag tells of the start. O(triangles + rows), and one search.
    void find(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features, const GroupRule& rule,
              const RowLists& found, Statistics& statistics);

    FeatureRows& rows() { return rows_; }

    /// Gives all memory back.
    void release();

   private:
    struct Entry {
        std::int32_t second;
        std::uint8_t start;
        double toi;
    };

    PreparedScene at_start(const PreparedScene& scene, const SceneFeatures& features);
    void list_triangles_of_vertices(const PreparedScene& scene, std::int64_t triangles);
    std::span<const std::int32_t> triangles_of(std::int32_t vertex) const;
    template <class Visit>
    void for_each_pair(const PreparedScene& scene, const SceneFeatures& features, const GroupRule& rule,
                       const RowLists& found, Visit visit) const;
    void write_rows(ParallelFor& workers);

    MemoryMeter& meter_;
    Array<std::int32_t> corners_;       ///< of the scene at the start, if vertices count as one
    Array<Pair> intersecting_;          ///< at the start, in any order
    Array<std::int64_t> first_use_;     ///< of each vertex, in uses_
    Array<std::int32_t> uses_;          ///< triangles that name it
    Array<std::int64_t> first_, kept_;  ///< of each first triangle: its entries, and how many differ
    Array<Entry> entries_;
    FeatureRows rows_;
};

}  // namespace crumple
