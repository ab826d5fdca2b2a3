#pragma once

// Distributed directory: finds which ranks have the same element, a triangle or a vertex. The ids over all ranks are
// cut into blocks, one per rank; the rank of the block that contains an id is the directory rank of that element. Ranks
// send data about their elements to the directory ranks, which compare them.

#include <cstdint>
#include <vector>

#include "crumple/distributed.h"
#include "distributed/rank_mesh.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

/// Elements of this rank, grouped by directory rank.
struct ByDirectoryRank {
    ByDirectoryRank() = default;
    /// Groups the elements whose flag in `chosen` is set; null: all elements.
    ByDirectoryRank(const Ids& ids, std::int64_t count, const std::vector<std::uint8_t>* chosen, int ranks);
    static std::int64_t block(std::int64_t all, int ranks) { return (all + ranks - 1) / ranks; }

    std::vector<std::int32_t> element;
    std::vector<std::int64_t> first;  ///< elements of directory rank r: [first[r], first[r + 1])
};

/// Throws the same Error on all ranks unless each triangle id occurs exactly once. All ids must be in range.
/// Collective.
void check_each_once(MessageBatches& batches, CollectiveCheck& agree, const Ids& ids, std::int64_t count);

/// Ghost vertices of this rank: vertices whose ids occur more than once over all ranks.
class GhostVertices {
   public:
    /// Finds the ghost vertices; without given ids there are none. Throws the same Error on all ranks if some vertex
    /// is on no rank. Collective.
    void learn(MessageBatches& batches, CollectiveCheck& agree, const Ids& ids, std::int64_t count);
    bool any() const { return any_; }  ///< true if any rank has ghost vertices
    bool shared(std::int32_t v) const { return any_ && shared_[static_cast<std::size_t>(v)]; }

    /// Throws the same Error on all ranks unless all copies of each ghost vertex are equal bit by bit. Only ghost
    /// vertices are sent. `when`: the time of the positions, as text that follows the vertex in the message of the
    /// error. Collective.
    void check(MessageBatches& batches, CollectiveCheck& agree, const VertexReader& reader, bool float32,
               const char* when) const;

   private:
    template <class Scalar>
    void check_copies(MessageBatches& batches, CollectiveCheck& agree, const VertexReader& reader,
                      const char* when) const;

    bool any_ = false;
    std::vector<std::uint8_t> shared_;          ///< 1 per local vertex: it is a ghost vertex
    ByDirectoryRank told_;                      ///< local ghost vertices, by directory rank
    Traffic traffic_{0};                        ///< rows sent and received in check(), 1 per ghost vertex
    std::vector<std::int32_t> kept_;            ///< by received row: index of the vertex in this rank's block of ids
    std::vector<std::int64_t> first_row_from_;  ///< by rank: index of the first row received from it; then the end
    std::int64_t block_begin_ = 0, block_size_ = 0, all_ = 0;
};

}  // namespace crumple::distribute
