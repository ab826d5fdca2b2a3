#pragma once

// What a part owns of an answer about all features in it, for backends that search a part as if it were a whole scene.

#include "queries/feature_request.h"

namespace crumple {

/// `answer` lists all pairs of the scene's features that are an answer. Leaves those that the query's part owns, which
/// is where the triangles that own the two features are a pair of the part, and of these as much as the query asks for.
void keep_owned(const PreparedScene& scene, const FeatureRequest& query, FeatureAnswer& answer);

}  // namespace crumple
