#pragma once

// What is told of near pairs on request, once the list is there: where they are closest, and how close each feature
// comes to any other.

#include "base/parallel_for.h"
#include "crumple/proximities.h"
#include "exact/proximity/resting_features.h"
#include "queries/feature_request.h"
#include "scene/prepared_scene.h"
#include "scene/scene_features.h"

namespace crumple {

/// Type and parameters of `pairs`, which are the scene's, into those of the list from `first` on.
void tell_closest(const PreparedScene& scene, const SceneFeatures& features, FeatureKind kind, const Array<Pair>& pairs,
                  std::size_t first, ParallelFor& workers, ProximityList& list);

/// The same of some rows, into `closest`. `workers`: null in one of their own tasks.
void find_closest(const PreparedScene& scene, const SceneFeatures& features, FeatureKind kind,
                  std::span<const FeatureHit> rows, ParallelFor* workers, Array<ClosestPoints>& closest);

/// Least distances of the features of a single mesh, from its complete lists.
void tell_least(const PreparedScene& scene, const SceneFeatures& features, ParallelFor& workers, Proximities& answer);

}  // namespace crumple
