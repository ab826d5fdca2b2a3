#pragma once

// Steps of `build` for one member of a leaf (small set of triangles that one sweep searches), for queries about
// features.

#include "backends/cpu/stages/layout.h"
#include "filters/features/feature_record.h"
#include "filters/features/length.h"
#include "scene/scene_features.h"

namespace crumple::cpu {

/// Reads the normalised corners of a triangle: those at the start, then those at the end.
template <int moments>
void corners_of(const BuildInput& in, std::int32_t triangle, Vec3d (&p)[3 * moments]) {
    const std::int32_t* corner = in.corners + 3 * std::int64_t{triangle};
    for (int k = 0; k < 3; ++k) {
        p[k] = in.points[corner[k]];
        if constexpr (moments == 2) p[3 + k] = in.points[static_cast<std::int32_t>(corner[k] + in.ends)];
    }
}

/// Returns the length by which a triangle's box is inflated on all sides. `p`: see corners_of().
template <int moments>
float widening(const BuildInput& in, std::int32_t triangle, const Vec3d (&p)[3 * moments]) {
    float way = 0;
    if constexpr (moments == 2)
        for (int k = 0; k < 3; ++k) way = max(way, length(to_float(p[3 + k] - p[k])));
    return in.inflation.of(triangle)(way);
}

/// Returns the member in the leaf's frame, with its box inflated.
template <int moments>
InFrame<3 * moments> widened(const BuildInput& in, std::int32_t triangle, const Vec3d (&p)[3 * moments]) {
    InFrame<3 * moments> member(p, in.frame);
    const float more = widening<moments>(in, triangle, p);
    member.low = member.low - Vec3f{more, more, more};
    member.high = member.high + Vec3f{more, more, more};
    member.reach += more;
    return member;
}

/// Writes the indices of a triangle's features, and which of them it owns.
template <int moments>
void write_feature_ids(const BuildInput& in, std::int32_t triangle, const SceneFeatures& features,
                       FeatureRecord<moments>& record) {
    const std::int32_t* corner = in.corners + 3 * std::int64_t{triangle};
    const TriangleEdges& edges = features.edges_of(triangle);
    for (std::size_t k = 0; k < 3; ++k) record.vertex[k] = corner[k], record.edge[k] = edges[k];
    record.triangle = triangle;
    record.owned = features.owned(triangle);
}

}  // namespace crumple::cpu
