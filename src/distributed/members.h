#pragma once

// Local triangles of a rank as members of parts of the scene, and the deltas that it has to send to the parts' owners,
// the ranks that search them.
//
// A part is a cluster of the last of one or more levels. A triangle of the part has a mask for each level (PartLevel):
// a bit for each cluster that the triangle belongs to, among the clusters into which the level divides the part's
// cluster of the level above.
//
// A part has a list of triangles and, for each rank that provides some of them, a list of vertices of that rank. Both
// lists change little from frame to frame: a few triangles enter and leave a part, some masks change, and each rank
// sends the coordinates of its list of vertices. In the first frame everything is added.
//
//     to the owner of part k:  removed      ids
//                              changed      ids, masks
//                              added        ids, groups, corners as indices into this rank's list of vertices; masks
//                              vertices     ids of those appended to the list, and whether they are ghost vertices
//                              coordinates  of this rank's whole list of vertices
//
// A triangle is examined again when it may have reached another part. Its slack is the distance that its corners may
// move until then (PartTree::mask); each frame subtracts the longest step of the three. Until it is examined, it may
// remain in a part that it has left, which costs a little time and does not change the result.

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "base/parallel_for.h"
#include "distributed/directory.h"
#include "distributed/feature_owners.h"
#include "distributed/part_layout.h"
#include "distributed/rank_mesh.h"

namespace crumple::distribute {

/// Message row of a triangle that is added to a part.
struct MemberRow {
    std::int32_t id, group;
    std::array<std::int32_t, 3> corners;  ///< indices into the sender's list of vertices
};

/// Numbers of rows of each type that one rank sends for one part.
struct DeltaCounts {
    std::int64_t removed = 0, changed = 0, added = 0, vertices = 0, coordinates = 0;
    friend bool operator==(const DeltaCounts&, const DeltaCounts&) = default;
};

/// Changes that this rank sends to the owner of one part.
struct PartDelta {
    std::vector<std::int32_t> removed, changed;  ///< ids
    std::vector<std::uint64_t> changed_masks;    ///< 1 per level for each changed triangle
    std::vector<MemberRow> added;
    std::vector<std::uint64_t> added_masks;     ///< 1 per level for each added triangle
    std::vector<OwnedFeatures> added_features;  ///< features that these own; empty for other queries
    std::vector<std::int32_t> vertices;         ///< ids of ghost vertices, -1 - id of others
};

class RankMembers {
   public:
    /// Finds what has changed since the previous call; after forget(), everything counts as changed.
    void update(const RankMesh& local, const PartLayout& layout, ParallelFor& workers);
    /// Sets the features to be sent with the triangles that own them, for queries about features; null for other
    /// queries.
    void set_features(const FeatureOwners* features) { features_ = features; }
    /// Returns the number of this rank's members in each part.
    std::span<const std::int64_t> counts() const { return counts_; }
    /// Returns the parts that this rank has, or has had, members in; ascending. Avoids loops over all parts, of which
    /// there may be thousands.
    std::span<const std::int32_t> parts() const { return parts_; }

    /// Marks a part with a new owner, to which all members must be sent.
    void send_again(std::int32_t part) { send_whole_[static_cast<std::size_t>(part)] = 1; }
    /// Adds all members of parts with a new owner to the deltas, and returns the approximate size of all deltas in
    /// bytes.
    std::int64_t bytes_of_changes();
    /// Makes the deltas of these parts.
    void make_rows(std::span<const std::int32_t> parts, const RankMesh& local, const GhostVertices& copies);

    PartDelta& delta(std::int32_t part) { return delta_[static_cast<std::size_t>(part)]; }
    DeltaCounts counts_of_delta(std::int32_t part) const;
    /// Returns this rank's vertices of a part, in the order in which their coordinates are sent.
    std::span<const std::int32_t> vertices(std::int32_t part) const {
        return list_[static_cast<std::size_t>(part)].vertices;
    }

    /// Frees the deltas of these parts, which have been sent.
    void sent(std::span<const std::int32_t> parts);
    void forget();
    /// True if the lists are so much longer than at first that they should be rebuilt: they still have the vertices of
    /// triangles that have left.
    bool stale() const;

   private:
    /// Parts of a triangle, ascending: entries [first, first + count) of part_ and masks_.
    struct Entries {
        std::int32_t first = 0, count = 0;
    };
    /// Result of find_entries() for a slice of the triangles: the entries of the triangles that were examined.
    struct Found {
        std::vector<std::int32_t> triangle, count, part;
        std::vector<std::uint64_t> masks;
    };
    using Coordinates = std::variant<std::vector<float>, std::vector<double>>;
    struct VertexList {
        std::vector<std::int32_t> vertices;
        std::size_t at_first = 0;
    };

    void measure_steps(const RankMesh& local, const PartLayout& layout, ParallelFor& workers);
    void measure_steps(const VertexReader& reader, const Normaliser& normalise, Coordinates& before,
                       ParallelFor& workers);
    bool may_have_reached_a_part(const PreparedScene& scene, std::int64_t t);
    Found find_entries(const RankMesh& local, const PartLayout& layout, std::int64_t begin, std::int64_t end);
    void take(std::int32_t triangle, std::span<const std::int32_t> parts, std::span<const std::uint64_t> masks);
    void send_some_whole();
    /// Index of each vertex in the list of the current part; valid if the vertex's stamp is that part.
    struct Places {
        std::vector<std::int32_t> place, stamp;
    };
    void number_corners(std::size_t part, const RankMesh& local, const GhostVertices& copies, Places& places);
    std::span<const std::uint64_t> masks(std::size_t entry) const { return {masks_.data() + depth_ * entry, depth_}; }

    /// Local triangles that leave a part, whose masks change, or that enter it; ascending.
    struct Changes {
        std::vector<std::int32_t> removed, changed, added;
    };

    const FeatureOwners* features_ = nullptr;
    std::size_t depth_ = 1;
    std::vector<Entries> entries_;  ///< by triangle
    std::vector<std::int32_t> part_;
    std::vector<std::uint64_t> masks_;  ///< 1 per level for each entry
    std::size_t entries_at_first_ = 0;
    std::vector<float> slack_;            ///< by triangle: distance that its corners may move until it is examined
    std::vector<float> step_;             ///< by vertex: distance that it has moved since the previous call
    Coordinates before_, before_at_end_;  ///< positions in the previous call

    std::vector<std::int32_t> parts_;
    std::vector<std::uint8_t> is_listed_;  ///< 1 per part: it is in parts_
    std::vector<std::int64_t> counts_;
    std::vector<Changes> changes_;
    std::vector<PartDelta> delta_;
    std::vector<VertexList> list_;
    std::vector<std::uint8_t> send_whole_;
};

}  // namespace crumple::distribute
