#pragma once

// Finds the pairs of triangles that meet during a step: pairs that intersect at its start, and pairs for which a
// feature of one triangle has an impact with a feature of the other. A backend finds intersections and impacts; this
// file derives the pairs of triangles from them, for any backend, and sorts them into rows.

#include <cstdint>
#include <span>

#include "backends/backend.h"
#include "crumple/array.h"
#include "queries/feature_request.h"
#include "scene/prepared_scene.h"
#include "scene/scene_features.h"
#include "scene/scene_filter.h"

namespace crumple {

class TriangleImpacts {
   public:
    explicit TriangleImpacts(MemoryMeter& meter);

    /// True if some pair of triangles intersects at the start. `scene`: the scene with the proxy triangles of
    /// `features`: degenerate ones for edges and points that no triangle owns (SceneFeatures::with_proxies).
    bool any_at_start(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features);

    /// Makes rows() from all impacts of features (`found`) and the pairs that intersect at the start. Each pair has one
    /// row, and rows are sorted. The value of a row is the first time at which the triangles meet; its flag is 1 if
    /// they intersect or touch at the start. Cost: O(triangles + rows), and one search for intersections.
    void find(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features, const SceneFilter& rule,
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
    void for_each_pair(const PreparedScene& scene, const SceneFeatures& features, const SceneFilter& rule,
                       const RowLists& found, Visit visit) const;
    void write_rows(ParallelFor& workers);

    MemoryMeter& meter_;
    Array<std::int32_t> corners_;       ///< representatives of all triangles' corners, if vertices are welded
    Array<Pair> intersecting_;          ///< pairs of triangles that intersect at the start, in any order
    Array<std::int64_t> first_use_;     ///< by vertex: start of its entries in `uses_`
    Array<std::int32_t> uses_;          ///< triangles that have the vertex as a corner, vertex by vertex
    Array<std::int64_t> first_, kept_;  ///< by first triangle of pairs: start of its entries, start of its rows
    Array<Entry> entries_;
    FeatureRows rows_;
};

}  // namespace crumple
