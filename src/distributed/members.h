#pragma once

// The triangles of one rank as members of parts, and what the parts' owners have not yet heard of them.
//
// A part is a list of triangles and, for each rank that has some of them, a list of that rank's vertices. Both change
// little from frame to frame: a few triangles enter and leave a part, some masks change, and each rank sends the
// coordinates of its list of vertices. A first frame is the same, with everything new.
//
//     to the owner of part k:  removed      ids
//                              changed      ids, masks
//                              added        ids, groups, corners as places in the list of vertices; masks
//                              vertices     ids of those that come to the list, and whether other ranks have copies
//                              coordinates  of the whole list
//
// A triangle is looked at again when it may have reached a further part: each knows how far its corners may move until
// then (PartTree::mask), and the longest step of the three is taken off that frame by frame. In between it may belong
// to a part that it has left, which costs a little and changes nothing.

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "base/parallel_for.h"
#include "distributed/directory.h"
#include "distributed/feature_owners.h"
#include "distributed/part_placement.h"
#include "distributed/share.h"

namespace crumple::distribute {

/// A triangle on its way to a part.
struct MemberRow {
    std::int32_t id, group;
    std::array<std::int32_t, 3> corners;  ///< places in the sender's list of vertices
};

/// How many rows of each sort one rank has for one part.
struct DeltaCounts {
    std::int64_t removed = 0, changed = 0, added = 0, vertices = 0, coordinates = 0;
    friend bool operator==(const DeltaCounts&, const DeltaCounts&) = default;
};

/// What one part's owner is told by this rank.
struct PartDelta {
    std::vector<std::int32_t> removed, changed;  ///< ids
    std::vector<std::uint64_t> changed_masks;    ///< one a level for each
    std::vector<MemberRow> added;
    std::vector<std::uint64_t> added_masks;     ///< the same
    std::vector<OwnedFeatures> added_features;  ///< what these own, of questions about features
    std::vector<std::int32_t> vertices;         ///< ids; less by one and negative where no other rank has a copy
};

class Members {
   public:
    /// Looks for what has changed since the call before; everything has after forget().
    void update(const Share& share, const Placement& placement, ParallelFor& workers);
    /// Questions about features: what triangles own is told, too. Null: others.
    void set_features(const FeatureOwners* features) { features_ = features; }
    /// How many members of each part this rank has.
    std::span<const std::int64_t> counts() const { return counts_; }
    /// The parts that it has, or has had, members of; ascending. Others are not looked at: there may be thousands.
    std::span<const std::int32_t> parts() const { return parts_; }

    /// The part gets an owner that knows nothing of it.
    void tell_anew(std::int32_t part) { anew_[static_cast<std::size_t>(part)] = 1; }
    /// Bytes of the deltas, about.
    std::int64_t bytes_of_changes();
    /// Makes the deltas of some parts ready to be sent.
    void make_rows(std::span<const std::int32_t> parts, const Share& share, const SharedVertices& copies);

    PartDelta& delta(std::int32_t part) { return delta_[static_cast<std::size_t>(part)]; }
    DeltaCounts counts_of_delta(std::int32_t part) const;
    /// This rank's vertices of a part, in the order in which their coordinates are sent.
    std::span<const std::int32_t> vertices(std::int32_t part) const {
        return list_[static_cast<std::size_t>(part)].vertices;
    }

    /// The owners of these have heard of it.
    void sent(std::span<const std::int32_t> parts);
    void forget();
    /// Lists of vertices keep those of triangles that have left: whether these have become many.
    bool stale() const;

   private:
    /// A triangle's parts, ascending: entries [first, first + count).
    struct Entries {
        std::int32_t first = 0, count = 0;
    };
    /// What a slice of the triangles has found: entries of those that were looked at.
    struct Found {
        std::vector<std::int32_t> triangle, count, part;
        std::vector<std::uint64_t> masks;
    };
    using Coordinates = std::variant<std::vector<float>, std::vector<double>>;
    struct VertexList {
        std::vector<std::int32_t> vertices;
        std::size_t at_first = 0;
    };

    void measure_steps(const Share& share, const Placement& placement, ParallelFor& workers);
    void measure_steps(const VertexReader& reader, const Normaliser& normalise, Coordinates& before,
                       ParallelFor& workers);
    bool may_have_reached_a_part(const PreparedScene& scene, std::int64_t t);
    Found look(const Share& share, const Placement& placement, std::int64_t begin, std::int64_t end);
    void take(std::int32_t triangle, std::span<const std::int32_t> parts, std::span<const std::uint64_t> masks);
    void tell_all_of_some();
    /// Of each vertex: its place in the list of the part that is looked at, if the stamp is the part's.
    struct Places {
        std::vector<std::int32_t> place, stamp;
    };
    void number_corners(std::size_t part, const Share& share, const SharedVertices& copies, Places& places);
    std::span<const std::uint64_t> masks(std::size_t entry) const { return {masks_.data() + depth_ * entry, depth_}; }

    /// Triangles that enter and leave a part, or have other masks; this rank's, ascending.
    struct Changes {
        std::vector<std::int32_t> removed, changed, added;
    };

    const FeatureOwners* features_ = nullptr;
    std::size_t depth_ = 1;
    std::vector<Entries> entries_;  ///< by triangle
    std::vector<std::int32_t> part_;
    std::vector<std::uint64_t> masks_;  ///< of each entry, one a level
    std::size_t entries_at_first_ = 0;
    std::vector<float> slack_;            ///< by triangle: how far corners may go until it is looked at again
    std::vector<float> step_;             ///< by vertex: how far it has gone since the call before
    Coordinates before_, before_at_end_;  ///< of the call before

    std::vector<std::int32_t> parts_;
    std::vector<std::uint8_t> is_listed_;  ///< in parts_
    std::vector<std::int64_t> counts_;
    std::vector<Changes> changes_;
    std::vector<PartDelta> delta_;
    std::vector<VertexList> list_;
    std::vector<std::uint8_t> anew_;
};

}  // namespace crumple::distribute
