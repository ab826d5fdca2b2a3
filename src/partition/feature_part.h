#pragma once

// Public parts of a scene (crumple/part.h) for queries about features. Each part records which vertices and edges its
// triangles own, because the owner of a feature may be in another part (docs/subdivide.md).

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

/// Contents of a query that parts need, except for vertex positions.
struct FeaturePartDemand {
    bool moving = false;
    double distance = 0, share = 0;
    bool weld = false;
    std::span<const double> radii = {};         ///< 1 per vertex, or empty
    const VertexReader* rest = nullptr;         ///< not owned; may be null
    const VertexRings* rings = nullptr;         ///< not owned; may be null
    std::span<const std::int32_t> groups = {};  ///< 1 per triangle that is no proxy triangle, or empty
};

/// Balls that determine to which parts triangles belong: each contains the triangle's swept volume, widened for the
/// distances of the query.
class FeatureBalls {
   public:
    FeatureBalls(const FeaturePartDemand& query, const Normaliser& normalise);
    PartBall operator()(const PreparedScene& scene, std::int64_t triangle) const;
    /// Returns the factor, at most 1, by which the slack of PartTree::mask() has to be multiplied, because a ball also
    /// grows with the longest path of a corner.
    double slack_of_path() const { return 3 / (3 + 2 * of_way_); }

   private:
    double length(double x) const;

    Normaliser normalise_;
    std::span<const double> radii_;
    double half_ = 0, of_way_ = 0;
};

/// Splits a scene, including its proxy triangles, into `count` parts. The result depends on the arguments only.
std::vector<Part> make_feature_parts(const PreparedScene& scene, const SceneFeatures& features,
                                     const FeaturePartDemand& query, int count, ParallelFor& parallel);

/// Throws Error (invalid_argument) if the part has no features, or if make_feature_parts() could not have made it. Does
/// not look at vertex positions. Includes check_part().
void check_feature_part(const Part& part);

/// Returns the vertex positions of a part at the end of a step; empty for a static part.
VertexView end_of(const PartFeatures& features);

/// Converts positions in the part's lists to ids in the mesh.
void name_globally(const Part& part, FeatureKind kind, Pair& pair);

}  // namespace crumple
