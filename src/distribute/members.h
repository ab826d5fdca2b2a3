#pragma once

// The triangles of one rank as members of parts, and what the parts' owners have not yet heard of them.
//
// A part is a list of triangles and, for each rank that has some of them, a list of that rank's vertices. Both grow and
// shrink by what changes: from frame to frame a few triangles enter and leave a part, some masks change, and each rank
// sends the coordinates of its list of vertices. A first frame is the same, with everything new.
//
//     to the owner of part k:  removed      ids
//                              changed      ids, masks
//                              added        ids, groups, corners as places in the list of vertices; masks
//                              vertices     ids of those that come to the list, if other ranks have copies, else -1
//                              coordinates  of the whole list

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "distribute/directory.h"
#include "distribute/placement.h"
#include "distribute/share.h"
#include "model/part.h"

namespace crumple::distribute {

/// A triangle on its way to a part.
struct MemberRow {
    std::int32_t id, group;
    std::array<std::int32_t, 3> corners;  ///< places in the sender's list of vertices
};

/// How many rows of each sort one rank has for one part.
struct DeltaCounts {
    std::int64_t removed = 0, changed = 0, added = 0, vertices = 0, coordinates = 0;
};

/// What one part's owner is told by this rank.
struct PartDelta {
    std::vector<std::int32_t> removed, changed;  ///< ids
    std::vector<std::uint64_t> changed_masks;    ///< one a level for each
    std::vector<MemberRow> added;
    std::vector<std::uint64_t> added_masks;  ///< the same
    std::vector<std::int32_t> vertices;      ///< ids, or -1
};

class Members {
   public:
    /// The members of all parts among this rank's triangles, as they lie now.
    void list(const Share& share, const Placement& placement, ParallelFor& workers);
    /// How many there are of each part.
    std::span<const std::int64_t> counts() const { return counts_; }

    /// What is new since the call before.
    void compare(const Share& share, const SharedVertices& copies, int depth);
    PartDelta& delta(std::int32_t part) { return delta_[static_cast<std::size_t>(part)]; }
    DeltaCounts counts_of_delta(std::int32_t part) const;
    /// This rank's vertices of a part, in the order in which their coordinates are sent.
    std::span<const std::int32_t> vertices(std::int32_t part) const {
        return sent_[static_cast<std::size_t>(part)].vertices;
    }

    /// The owners have heard of it.
    void sent();
    /// The owner of a part knows nothing of it.
    void forget(std::int32_t part) { sent_[static_cast<std::size_t>(part)] = {}; }
    void forget() { sent_.clear(); }
    /// Lists of vertices keep those of triangles that have left: whether these have become many.
    bool stale() const;

   private:
    /// What a part's owner has of this rank.
    struct Sent {
        std::vector<std::int32_t> triangles;  ///< of this rank, ascending
        std::vector<std::uint64_t> masks;     ///< one a level for each
        std::vector<std::int32_t> vertices;   ///< of this rank, as sent
        std::size_t vertices_at_first = 0;
    };
    void compare_part(std::size_t k, const Share& share, const SharedVertices& copies, std::size_t depth);
    void add_corners(std::size_t k, std::span<const std::int32_t> triangles, const Share& share,
                     const SharedVertices& copies);

    std::vector<std::int64_t> counts_;
    std::vector<Sent> sent_, now_;
    std::vector<PartDelta> delta_;
    std::vector<std::int32_t> place_;  ///< of each vertex in the list of the part that is looked at
    std::vector<std::int32_t> stamp_;  ///< the part that place_ is of
};

}  // namespace crumple::distribute
