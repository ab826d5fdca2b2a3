#pragma once

// Public parts of a scene that is asked about its features (crumple/part.h): each part takes along who owns which
// vertex and edge, for the triangle that owns one may be in another part (docs/subdivide.md).

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

/// What a question says of the scene beside where its vertices are.
struct FeaturePartQuestion {
    bool moving = false;
    double distance = 0, share = 0;
    bool weld = false;
    std::span<const double> radii = {};         ///< of each vertex, or empty
    const VertexReader* rest = nullptr;         ///< or null
    const VertexRings* rings = nullptr;         ///< or null
    std::span<const std::int32_t> groups = {};  ///< of each triangle that is no carrier, or empty
};

/// By which balls triangles belong to parts: their whole way, widened by as much as the question asks for.
class FeatureBalls {
   public:
    FeatureBalls(const FeaturePartQuestion& question, const Normaliser& normalise);
    PartBall operator()(const PreparedScene& scene, std::int64_t triangle) const;
    /// So many times what its corners may move suffices for a ball that reaches nothing further (PartTree::mask).
    double slack_of_way() const { return 3 / (3 + 2 * of_way_); }

   private:
    double length(double x) const;

    Normaliser normalise_;
    std::span<const double> radii_;
    double half_ = 0, of_way_ = 0;
};

/// Cuts a scene, carriers among its triangles, into `count` parts; depends only on the arguments.
std::vector<Part> make_feature_parts(const PreparedScene& scene, const SceneFeatures& features,
                                     const FeaturePartQuestion& question, int count, ParallelFor& parallel);

/// Throws Error (invalid_argument, index_out_of_range) if the part has no features, or none that make_feature_parts()
/// could have made, as far as that shows without a look at where its vertices are. Checks what check_part() does, too.
void check_feature_part(const Part& part);

/// Where a part's vertices are at the end of a step; empty for a part at rest.
VertexView end_of(const PartFeatures& features);

/// From positions in the part's lists to ids in the mesh.
void name_globally(const Part& part, FeatureKind kind, Pair& pair);

}  // namespace crumple
