#pragma once

// Parts of stages `sort` and `sweep` that are specific to feature queries: records by row, and a filter by separating
// directions that runs before a pair is listed.

#include <limits>

#include "backends/cuda/device/warp_gather.h"
#include "backends/cuda/features/feature_parameters.h"
#include "backends/cuda/stages/layout.h"
#include "filters/features/feature_filters.h"
#include "filters/features/separating_direction.h"

namespace crumple::cuda {

template <int moments>
struct FeatureMemberRows {
    FeatureRecord<moments>* record;
    FeatureTable features;

    __device__ void put(std::uint32_t row, std::int32_t triangle, const Vec3d p[3 * moments], const std::int32_t id[3],
                        const InFrame<3 * moments>& member, const Frame&) const {
        FeatureRecord<moments> made;
        write_geometry<moments>(p, member, made);
        const TriangleEdges edges = features.edges_of[triangle];
        for (std::size_t k = 0; k < 3; ++k) made.vertex[k] = id[k], made.edge[k] = edges[k];
        made.triangle = triangle;
        made.owned = features.owned[triangle];
        record[row] = made;
    }
};

/// Filter that drops pairs which some direction separates by more than both the query's distance (or the sum of the
/// triangles' radii) and the given fraction of the distance at the start (NeededGap).
template <int moments>
struct SeparatingAxisTest {
    const FeatureRecord<moments>* record;
    Frames frames;
    const std::uint16_t* leaf;
    const Inflation* inflation;
    const float* triangle_radius;
    float share;  ///< share of a pair's distance at the start that must remain, rounded up

    using Buffer = GatherBuffer<FeatureRecord<moments>>;
    __device__ bool keeps(bool has, const Candidate& c, Buffer& buffer) const {
        const auto [a, b] = gathered_pair(record, c.row, c.column, buffer);
        if (!has) return false;
        const float asked =
            triangle_radius ? triangle_radius[a.triangle] + triangle_radius[b.triangle] : 2 * inflation->half;
        return !surely_apart(a, b, NeededGap(asked, frames.extent_of(leaf[c.row]), share).of(a, b));
    }
};

}  // namespace crumple::cuda
