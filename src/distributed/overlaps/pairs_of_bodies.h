#pragma once

// Pairs of bodies of all ranks, for queries about whole bodies, and the rank that searches each pair. Every rank has a
// table with the boxes of all bodies, and makes the same list of pairs and the same owners from it.
//
//     boxes of local bodies --one reduction--> table --sweep, pair filter--> pairs of bodies whose boxes overlap
//     pairs, by descending number of triangles --> ranks that have one of the bodies, or the rank with the least load

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "crumple/overlaps.h"
#include "distributed/part_layout.h"
#include "distributed/rank_bodies.h"

namespace crumple::distribute {

class PairsOfBodies {
   public:
    /// Row of a table of bodies that all ranks have, besides that of Bodies.
    struct Row {
        Bounds box = no_bounds;  ///< tight box of the posed vertices; empty for a body without triangles
        std::int32_t group = 0;
        bool closed = true;  ///< true if its surface is closed
    };

    /// Exchanges the rows of all bodies. `mine`: one per local body. Collective.
    void tabulate(Transport& transport, CollectiveCheck& agree, const Bodies& bodies, std::span<const Row> mine);
    /// Lists the pairs that the query selects, as on a single machine.
    void list(const OverlapQuery& query);
    /// Assigns each pair to a rank, so that the ranks have about the same number of triangles to search, preferably to
    /// a rank that has one of the bodies. Depends on the tables only.
    void assign(const Bodies& bodies, int ranks);

    /// Selected pairs of bodies whose boxes overlap, sorted; with self_overlaps also those of a body with itself.
    std::span<const BodyPair> near() const { return near_; }
    /// Bodies of near pairs whose surfaces are not closed, by their first occurrence.
    std::span<const std::int32_t> open_bodies() const { return open_; }
    const Row& row(std::int32_t body) const { return table_[static_cast<std::size_t>(body)]; }
    /// Returns the pairs that a rank searches, sorted.
    std::vector<BodyPair> pairs_of(int rank) const;
    /// Returns the other ranks that search a pair with the body, for the bodies of one rank: (rank, body), sorted.
    std::vector<std::pair<int, std::int32_t>> destinations(const Bodies& bodies, int rank) const;

   private:
    std::vector<Row> table_;
    std::vector<BodyPair> near_;
    std::vector<BodyPair> pairs_;  ///< those of near_ that are searched
    std::vector<std::int32_t> open_;
    Owners owners_;  ///< by pair
};

}  // namespace crumple::distribute
