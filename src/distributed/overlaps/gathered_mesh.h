#pragma once

// The mesh of all ranks, and pairs of its triangles, gathered on one rank: the input of the overlap of a mesh with
// itself, whose winding numbers need the whole surface. Positions have the bits that the ranks have.

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "base/memory_claim.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "distributed/rank_mesh.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

class GatheredMesh {
   public:
    /// Gathers everything on rank `root`. `meter` counts the gathered arrays.
    GatheredMesh(MessageBatches& batches, CollectiveCheck& agree, MemoryMeter& meter, int root)
        : batches_(batches), agree_(agree), memory_(meter), root_(root), pairs_(&meter) {}

    bool is_root() const { return batches_.transport().rank() == root_; }
    /// Sends the local mesh to the root. `float32`: true if all ranks have float32 coordinates. Collective.
    void gather(const RankMesh& local, bool float32);
    /// Sends pairs of triangles to the root. Collective.
    void gather(std::span<const Pair> pairs);

    // On the root:
    /// Returns the mesh of all ranks, with the numbers of vertices and triangles over all ranks.
    MeshView view() const;
    /// Returns the pairs of all ranks, those of rank 0 first.
    Array<Pair>& pairs() { return pairs_; }

   private:
    template <class Scalar>
    void gather_vertices(const RankMesh& local);
    void gather_triangles(const RankMesh& local);
    template <class Row, class Reserve, class Pack, class Unpack>
    void send(std::int64_t rows, Reserve reserve, Pack pack, Unpack unpack);

    MessageBatches& batches_;
    CollectiveCheck& agree_;
    MemoryClaim memory_;
    int root_;
    std::variant<std::vector<float>, std::vector<double>> vertices_;
    std::vector<std::int32_t> corners_;
    Array<Pair> pairs_;
};

}  // namespace crumple::distribute
