#pragma once

// Finds the pairs of triangles of a step: those that intersect at its start, and those of which an impact names one
// feature each. Independent of the backend, which finds intersections and impacts; this file derives the pairs of
// triangles from them, and counts and sorts them into rows.

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

    /// True if some pair intersects at the start. `scene`: with the proxy triangles of `features`.
    bool any_at_start(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features);

    /// Makes rows() from all impacts of features and the pairs that intersect at the start: unique, sorted; the value
    /// is the first time, the flag is set if they intersect or touch at the start. O(triangles + rows), and one search.
    void find(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features, const GroupFilter& rule,
              const RowLists& found, Statistics& statistics);

    FeatureRows& rows() { return rows_; }

    /// Frees all memory.
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
    void for_each_pair(const PreparedScene& scene, const SceneFeatures& features, const GroupFilter& rule,
                       const RowLists& found, Visit visit) const;
    void write_rows(ParallelFor& workers);

    MemoryMeter& meter_;
    Array<std::int32_t> corners_;       ///< corners of the scene at the start, if vertices are welded
    Array<Pair> intersecting_;          ///< pairs at the start, in any order
    Array<std::int64_t> first_use_;     ///< start of each vertex in `uses_`
    Array<std::int32_t> uses_;          ///< triangles that name each vertex
    Array<std::int64_t> first_, kept_;  ///< start of the entries of each first triangle, and of its rows
    Array<Entry> entries_;
    FeatureRows rows_;
};

}  // namespace crumple
