#pragma once

// Updates the parts of the scene on their owners, the ranks that search them: sends deltas (members.h) first, then
// coordinates, which are received directly into the arrays that searches read. Large deltas are sent in groups of
// parts, so that they are never all in memory at once.

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/function_ref.h"
#include "distributed/assembled_part.h"
#include "distributed/by_part.h"
#include "distributed/members.h"
#include "distributed/part_layout.h"
#include "distributed/rank_mesh.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

class Delivery {
   public:
    /// `mine`: the parts that this rank owns, ascending. `depth`: number of levels of clusters, and so of masks per
    /// triangle.
    Delivery(MessageBatches& batches, CollectiveCheck& agree, const Owners& owners, RankMembers& members,
             const RankMesh& local, const GhostVertices& copies, std::vector<AssembledPart>& mine, std::size_t depth);

    /// Contents of a delivery. `features`: includes features that triangles own. `moving`: includes end positions.
    struct What {
        bool float32 = true, features = false, moving = false;
    };
    /// Updates all parts, in one or several groups. Collective. In each group, before memory for the parts of this rank
    /// is allocated, calls room(bytes) with the number of additional bytes.
    void run(const What& what, FunctionRef<void(std::int64_t bytes)> room);

   private:
    /// Counts of the rows that this rank sends for a part, which may be one of its own. Parts for which it sends none
    /// have no entry.
    struct Leaving {
        int rank;  ///< owner of the part
        std::int32_t part;
        DeltaCounts counts;
    };
    /// Counts of the rows that a rank, possibly this one, sends for a part of this rank.
    struct Coming {
        int rank;
        std::size_t mine;  ///< index of the part in mine_
        DeltaCounts counts;
        RankDelta* news;  ///< null: only coordinates are sent
    };
    /// Message row: a part and its counts.
    struct CountsRow {
        std::int64_t part;
        DeltaCounts counts;
    };

    int choose_groups();
    void run_group(int group, int groups, FunctionRef<void(std::int64_t bytes)> room);
    void list_leaving();
    void exchange_counts();
    std::int64_t bytes_coming() const;
    void reserve();
    void exchange_news();
    template <class Scalar>
    void exchange_coordinates(const VertexReader& reader, bool at_end);

    /// Exchanges count(counts) rows for each entry of leaving_ and coming_. pack(leaving, first, rows) writes the
    /// entry's rows from `first` on, to be sent; unpack(coming, first, rows) reads received ones.
    template <class Row, class Count, class Pack, class Unpack>
    void stream(Count count, Pack pack, Unpack unpack);
    /// Exchanges one list of each delta: list(delta), which has `each` elements per row and count(counts) rows.
    template <class Element, class Count, class List>
    void stream_list(Count count, std::int64_t each, List list);

    MessageBatches& batches_;
    CollectiveCheck& check_;
    const Owners& owners_;
    RankMembers& members_;
    const RankMesh& local_;
    const GhostVertices& copies_;
    std::vector<AssembledPart>& all_mine_;
    std::int64_t depth_;
    What what_;
    int ranks_;
    std::vector<std::int32_t> place_;  ///< 1 per part: its position among the parts of its owner
    int most_parts_ = 1;               ///< largest number of parts that a rank owns

    // Current group of parts:
    std::vector<std::int32_t> parts_;  ///< parts that this rank has, or had, members in
    std::vector<AssembledPart*> mine_;
    std::vector<Leaving> leaving_;              ///< by owner, then part
    std::vector<Coming> coming_;                ///< by rank, then part
    std::vector<std::vector<RankDelta>> news_;  ///< by part of this rank: the deltas received
};

}  // namespace crumple::distribute
