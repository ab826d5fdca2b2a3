#pragma once

// Optional details of proximities, made from complete lists: closest points of each pair, and least distance of each
// feature.

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/features.h"
#include "crumple/proximities.h"
#include "scene/prepared_scene.h"
#include "scene/scene_features.h"

namespace crumple {

/// Appends type and parameters of the closest points of `pairs`, which have indices of the scene, to list.type and
/// list.at. `workers`: null if called within a task of the workers.
void append_closest(const PreparedScene& scene, const SceneFeatures& features, FeatureKind kind,
                    const Array<Pair>& pairs, ParallelFor* workers, ProximityList& list);

/// Makes the least distances of all features of a single mesh from its lists, which must be complete: no pair within
/// the radius may be missing.
void add_least_distances(const PreparedScene& scene, const SceneFeatures& features, ParallelFor& workers,
                         Cancellation& cancellation, Proximities& answer);

/// Holds the least distances of a result while another search makes its lists: swap_with() swaps them with those of the
/// result.
struct LeastDistances {
    Array<double> of_vertices, of_faces, of_edges;

    void swap_with(Proximities& result) {
        of_vertices.swap_elements(result.vertex_distance);
        of_faces.swap_elements(result.face_distance);
        of_edges.swap_elements(result.edge_distance);
    }
};

/// Adds the requested details to a result whose pairs have indices of the scene.
void add_details(const PreparedScene& scene, const SceneFeatures& features, const ProximityQuery& query,
                 ParallelFor& workers, Cancellation& cancellation, Proximities& result);

}  // namespace crumple
