#pragma once

// Selects the rows that a part owns, for backends that search a part as if it were a whole scene.

#include "queries/feature_request.h"

namespace crumple {

/// Reduces a result, which must have all impacts or proximities of the scene's features, to the rows that the request's
/// part owns, and then to the request's extent. A part owns a pair if the triangles that own the two features are a
/// pair of the part.
void keep_owned(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result);

}  // namespace crumple
