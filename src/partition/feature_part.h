#pragma once

// Public parts of a scene (crumple/part.h) for queries about features: faces, edges and vertices. The lowest triangle
// of the scene that contains a feature owns it. Each part records which vertices and edges its triangles own, because
// the owner of a feature may be in another part (docs/subdivide.md).

#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/features.h"
#include "crumple/intersections.h"
#include "crumple/part.h"
#include "partition/part_tree.h"
#include "scene/prepared_scene.h"
#include "scene/scene_features.h"
#include "scene/vertex_rings.h"

namespace crumple {

/// Settings of a query that parts are made for, with the meaning of those in PartFeatures.
struct FeaturePartDemand {
    bool moving = false;
    double distance = 0, share = 0;
    bool weld = false;
    std::span<const double> radii = {};         ///< 1 per vertex, or empty
    const VertexReader* rest = nullptr;         ///< positions of the rest shape, or null; not owned
    const VertexRings* rings = nullptr;         ///< adjacent vertices by ProximityQuery::rings, or null; not owned
    std::span<const std::int32_t> groups = {};  ///< 1 per triangle except for proxy triangles, or empty
};

/// Function object that returns the ball which determines to which parts a triangle belongs: it contains the triangle's
/// swept volume, and is widened for the distances of the query.
class FeatureBallOfTriangle {
   public:
    FeatureBallOfTriangle(const FeaturePartDemand& query, const Normaliser& normalise);
    PartBall operator()(const PreparedScene& scene, std::int64_t triangle) const;
    /// Returns the factor, at most 1, by which the slack that PartTree::mask() computes has to be multiplied: it does
    /// not take into account that these balls also grow with the longest path of a corner.
    double slack_of_path() const { return 3 / (3 + 2 * path_share_); }

   private:
    double length(double x) const;

    Normaliser normalise_;
    std::span<const double> radii_;
    double half_distance_ = 0, path_share_ = 0;  ///< half the query's distance, and the factor of the longest path
                                                 ///< (inflation.h), in normalised coordinates
};

/// Splits a scene into `count` parts, including its proxy triangles (degenerate triangles that own edges and points
/// which no triangle owns). The result depends on the arguments only.
std::vector<Part> make_feature_parts(const PreparedScene& scene, const SceneFeatures& features,
                                     const FeaturePartDemand& query, int count, ParallelFor& parallel);

/// Throws Error (invalid_argument) if the part has no features, or if sizes, ids and indices of its arrays contradict
/// each other. Checks neither vertex positions nor the triangles' corners. Includes check_part().
void check_feature_part(const Part& part);

/// Returns the vertex positions of a part at the end of a step; empty for a static part.
VertexView end_of(const PartFeatures& features);

/// Converts a pair of features from indices within the part to ids in the mesh.
void name_globally(const Part& part, FeatureKind kind, Pair& pair);

}  // namespace crumple
