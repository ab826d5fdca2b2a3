#pragma once

// Steps of `build` for one member of a leaf (small set of triangles that one sweep searches), for queries about
// features.

#include "backends/cpu/stages/layout.h"
#include "filters/features/feature_record.h"
#include "filters/features/length.h"
#include "scene/scene_features.h"

namespace crumple::cpu {

/// Returns the origin of a leaf's frame. `sample`: 0 for the start of the step, 1 for its end.
template <int moments>
Vec3f origin_at(const BuildInput& in, int sample) {
    return moments == 1 ? in.frame.origin : in.frame.origin + (static_cast<float>(sample) - 0.5f) * in.drift;
}

/// Reads the normalised corners of a triangle, relative to the frame's origin at the same time: those at the start,
/// then, if they move, those at BuildInput::until.
template <int moments>
void corners_of(const BuildInput& in, std::int32_t triangle, Vec3d (&p)[3 * moments]) {
    const std::int32_t* corner = in.corners + 3 * std::int64_t{triangle};
    for (int sample = 0; sample < moments; ++sample) {
        const Vec3f o = origin_at<moments>(in, sample);
        for (int k = 0; k < 3; ++k)
            p[3 * sample + k] =
                in.points[static_cast<std::int32_t>(corner[k] + sample * in.ends)] - Vec3d{o.x, o.y, o.z};
    }
    if constexpr (moments == 2)
        for (int k = 0; k < 3 && in.until < 1; ++k) p[3 + k] = p[k] + double{in.until} * (p[3 + k] - p[k]);
}

/// Returns the length by which a triangle's box is inflated on all sides. `p`: see corners_of(). Coordinates of `p` err
/// by a few 2^-53 of the largest one. The length of each trajectory is increased by 2^-48 of it, which covers these
/// errors; that matters only for shares of nearly 1.
template <int moments>
float widening(const BuildInput& in, std::int32_t triangle, const Vec3d (&p)[3 * moments]) {
    float way = 0;
    if constexpr (moments == 2) {
        double reach = 0;
        for (int k = 0; k < 3; ++k) {
            way = max(way, length(to_float(p[3 + k] - p[k])));
            reach = max(reach, max(largest(abs(p[k])), largest(abs(p[3 + k]))));
        }
        way += static_cast<float>(0x1p-48 * reach);
    }
    return in.inflation.of(triangle)(way);
}

/// Returns the member in the leaf's frame, with its box inflated.
template <int moments>
InFrame<3 * moments> widened(const BuildInput& in, std::int32_t triangle, const Vec3d (&p)[3 * moments]) {
    LeafFrame frame = in.frame;
    frame.origin = {};
    InFrame<3 * moments> member(p, frame);
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
