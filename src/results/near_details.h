#pragma once

// Details of near pairs that a query may have, once the list is there: where they are closest, and how close each
// feature comes to any other.

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/features.h"
#include "crumple/proximities.h"
#include "scene/prepared_scene.h"
#include "scene/scene_features.h"

namespace crumple {

/// Appends type and parameters of `pairs`, which are the scene's, to those of the list. `workers`: null in one of their
/// own tasks.
void append_closest(const PreparedScene& scene, const SceneFeatures& features, FeatureKind kind,
                    const Array<Pair>& pairs, ParallelFor* workers, ProximityList& list);

/// Least distances of the features of a single mesh, from its complete lists.
void tell_least(const PreparedScene& scene, const SceneFeatures& features, ParallelFor& workers, Proximities& answer);

/// Least distances of a result while its lists are searched once more: take() swaps them with the result's.
struct LeastDistances {
    Array<double> of_vertices, of_faces, of_edges;

    void take(Proximities& result) {
        of_vertices.swap_elements(result.vertex_distance);
        of_faces.swap_elements(result.face_distance);
        of_edges.swap_elements(result.edge_distance);
    }
};

/// Adds what the query has of these to a result whose pairs are the scene's.
void add_details(const PreparedScene& scene, const SceneFeatures& features, const ProximityQuery& query,
                 ParallelFor& workers, Proximities& result);

}  // namespace crumple
