#pragma once

// Input of the exact decision about two features: the four points, at the start and at the end. Compiled for host and
// device.

#include <array>

#include "crumple/features.h"
#include "exact/impact/impact.h"
#include "exact/proximity/static_features.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Points of two features. vertex_face: the vertex, then the face's corners. edge_edge: a, b of the first edge, then c,
/// d of the second. vertex_edge: the vertex, a and b of the edge, then b again. vertex_vertex: one vertex, then the
/// other three times. So pairs of the last two kinds look like a vertex and a face that is collapsed to an edge or a
/// point.
using FeaturePoints = std::array<MovingPoint, 4>;

/// Returns the trajectory of a vertex, exact: reads the caller's coordinates. Both ends are equal in static scenes.
CRUMPLE_HD inline MovingPoint moving_point(const PreparedScene& scene, std::int32_t vertex) {
    const Vec3d start = scene.position(vertex);
    return {start, scene.moving ? scene.end(vertex) : start};
}

CRUMPLE_HD inline FeaturePoints points_of(const PreparedScene& scene, const std::int32_t (&vertex)[4]) {
    return {moving_point(scene, vertex[0]), moving_point(scene, vertex[1]), moving_point(scene, vertex[2]),
            moving_point(scene, vertex[3])};
}

CRUMPLE_HD inline FeatureKinds kinds_of(FeatureKind kind) {
    return static_cast<FeatureKinds>(kind);  // both enums have the same order
}

/// Returns the features at their start positions, as static ones.
CRUMPLE_HD inline Features at_start(FeatureKind kind, const FeaturePoints& p) {
    return {kinds_of(kind), {p[0].start, p[1].start, p[2].start, p[3].start}};
}

}  // namespace crumple
