#pragma once

// What a decision about two features is given: the four points, at the start and at the end.

#include <array>

#include "crumple/features.h"
#include "model/scene.h"
#include "questions/motion/impact.h"

namespace crumple {

/// vertex_face: the vertex, then the face's corners. edge_edge: a b of the first edge, c d of the second.
using FeaturePoints = std::array<MovingPoint, 4>;

/// Exact: what the caller gave.
inline MovingPoint moving_point(const Scene& scene, std::int32_t vertex) {
    const Vec3d start = scene.position(vertex);
    return {start, scene.moving ? scene.end(vertex) : start};
}

inline FeaturePoints vertex_face_points(const Scene& scene, std::int32_t vertex, const std::int32_t* corners) {
    return {moving_point(scene, vertex), moving_point(scene, corners[0]), moving_point(scene, corners[1]),
            moving_point(scene, corners[2])};
}

inline FeaturePoints edge_edge_points(const Scene& scene, const Edge& e, const Edge& f) {
    return {moving_point(scene, e.a), moving_point(scene, e.b), moving_point(scene, f.a), moving_point(scene, f.b)};
}

}  // namespace crumple
