#pragma once

// Who else has an element: ids are cut into blocks, one a rank, and each rank keeps the book of its block. What ranks
// say of their elements goes to the book keepers, who compare.

#include <cstdint>
#include <vector>

#include "crumple/distributed.h"
#include "distributed/share.h"
#include "distributed/transport/agreement.h"
#include "distributed/transport/rounds.h"

namespace crumple::distribute {

/// Elements of this rank in the order of the ranks that keep the books about them.
struct ByKeeper {
    ByKeeper() = default;
    /// Of all elements whose flag is set; null: of all.
    ByKeeper(const Ids& ids, std::int64_t count, const std::vector<std::uint8_t>* chosen, int ranks);
    static std::int64_t block(std::int64_t all, int ranks) { return (all + ranks - 1) / ranks; }

    std::vector<std::int32_t> element;
    std::vector<std::int64_t> first;  ///< of each rank, and the end
};

/// Throws the same Error on all ranks unless each triangle is there once. Of ids that are in range.
void check_each_once(Rounds& rounds, Agreement& agree, const Ids& ids, std::int64_t count);

/// Vertices of which several ranks have copies.
class SharedVertices {
   public:
    /// Where no ids are given, there are none. Throws the same Error on all ranks if a vertex is missing.
    void learn(Rounds& rounds, Agreement& agree, const Ids& ids, std::int64_t count);
    bool any() const { return any_; }  ///< on some rank
    bool shared(std::int32_t v) const { return any_ && shared_[static_cast<std::size_t>(v)]; }

    /// Throws the same Error on all ranks unless all copies are equal, bit by bit. Only those that are shared travel.
    /// `when` follows the vertex in the message.
    void check(Rounds& rounds, Agreement& agree, const VertexReader& reader, bool float32, const char* when) const;

   private:
    template <class Scalar>
    void check_copies(Rounds& rounds, Agreement& agree, const VertexReader& reader, const char* when) const;

    bool any_ = false;
    std::vector<std::uint8_t> shared_;  ///< by vertex of this rank
    ByKeeper told_;                     ///< the shared ones
    Traffic traffic_{0};                ///< of them
    std::vector<std::int32_t> kept_;    ///< by row that comes in: which of this rank's block
    std::vector<std::int64_t> first_from_;
    std::int64_t block_begin_ = 0, block_size_ = 0, all_ = 0;
};

}  // namespace crumple::distribute
