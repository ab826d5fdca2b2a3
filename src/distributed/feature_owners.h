#pragma once

// Finds the triangles that own vertices and edges over all ranks, and numbers the edges. As on a single machine
// (scene/scene_features.h), the lowest triangle that has a feature owns it, and edges are numbered in the lexicographic
// order of their vertices. The directory rank of an edge's lower vertex receives all triangles that have the edge.

#include <array>
#include <cstdint>
#include <vector>

#include "distributed/directory.h"
#include "distributed/rank_mesh.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

/// Features that a triangle owns. Bit k of `owned`: the vertex at corner k; bit 3 + k: the edge that starts there,
/// whose number is edges[k].
struct OwnedFeatures {
    std::array<std::int32_t, 3> edges{-1, -1, -1};
    std::int32_t owned = 0;
};

class FeatureOwners {
   public:
    void learn(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local, const GhostVertices& copies);
    bool known() const { return known_; }
    void forget() { *this = {}; }
    const OwnedFeatures& of(std::int64_t triangle) const { return of_[static_cast<std::size_t>(triangle)]; }

   private:
    void own_vertices(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local,
                      const GhostVertices& copies);
    void own_edges(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local);

    bool known_ = false;
    std::vector<OwnedFeatures> of_;  ///< 1 per local triangle
};

}  // namespace crumple::distribute
