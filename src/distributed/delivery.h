#pragma once

// Brings parts on their owners up to date: what is new travels first, then the coordinates, straight to where the
// engines read them. Where much is new, some parts of each rank at a time, so that what is on its way is never all of
// it.

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/function_ref.h"
#include "distributed/assembled_part.h"
#include "distributed/by_part.h"
#include "distributed/members.h"
#include "distributed/part_placement.h"
#include "distributed/share.h"
#include "distributed/transport/agreement.h"
#include "distributed/transport/rounds.h"

namespace crumple::distribute {

class Delivery {
   public:
    /// `mine`: the parts of this rank, ascending.
    Delivery(Rounds& rounds, Agreement& agree, const Owners& owners, Members& members, const Share& share,
             const SharedVertices& copies, std::vector<AssembledPart>& mine, std::size_t depth);

    /// What travels. `features`: what triangles own is told, too. `moving`: so are vertices at their ends.
    struct What {
        bool float32 = true, features = false, moving = false;
    };
    /// `room(bytes)` is told, before they are taken, what the parts of this rank will need more.
    void run(const What& what, FunctionRef<void(std::int64_t bytes)> room);

   private:
    /// What this rank has for a part of another, or of its own. Ranks that have nothing for a part do not speak of it.
    struct Leaving {
        int rank;  ///< the owner
        std::int32_t part;
        DeltaCounts counts;
    };
    /// What another rank, or this one, has for a part of this.
    struct Coming {
        int rank;
        std::size_t mine;
        DeltaCounts counts;
        PartNews* news;  ///< null: coordinates alone
    };
    /// As it travels.
    struct CountsRow {
        std::int64_t part;
        DeltaCounts counts;
    };

    int choose_groups();
    void run_group(int group, int groups, FunctionRef<void(std::int64_t bytes)> room);
    void list_leaving();
    void exchange_counts();
    std::int64_t bytes_coming() const;
    void make_room();
    void exchange_news();
    template <class Scalar>
    void exchange_coordinates(const VertexReader& reader, bool at_end);

    /// Of each part `count(counts)` rows: pack(what leaves, first, rows), unpack(what comes, first, rows).
    template <class Row, class Count, class Pack, class Unpack>
    void stream(Count count, Pack pack, Unpack unpack);
    /// A list of each delta: `list(delta)`, with `each` elements for each of `count(counts)`.
    template <class Element, class Count, class List>
    void stream_list(Count count, std::int64_t each, List list);

    Rounds& rounds_;
    Agreement& agree_;
    const Owners& owners_;
    Members& members_;
    const Share& share_;
    const SharedVertices& copies_;
    std::vector<AssembledPart>& all_mine_;
    std::int64_t depth_;
    What what_;
    int ranks_;
    std::vector<std::int32_t> place_;  ///< of each part among those of its owner
    int most_parts_ = 1;               ///< that a rank owns

    // Of the group that is on its way:
    std::vector<std::int32_t> parts_;  ///< that this rank has something for, or had
    std::vector<AssembledPart*> mine_;
    std::vector<Leaving> leaving_;             ///< by owner, then part
    std::vector<Coming> coming_;               ///< by rank, then part
    std::vector<std::vector<PartNews>> news_;  ///< of each of my parts, by rank
};

}  // namespace crumple::distribute
