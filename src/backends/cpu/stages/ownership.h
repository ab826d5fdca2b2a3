#pragma once

// Ownership of pairs of triangles by leaves (each is a set of triangles that one sweep searches), so that each pair is
// handled once. Clusters overlap, so several leaves may contain both triangles. Leaf (k1, k2), child k2 of cluster k1,
// owns the pair iff no lower cluster contains both triangles: no cluster below k1 in the first level, no child of k1
// below k2 in the second and, if the scene is a part of a larger one, no cluster below the part's in the levels above
// (docs/subdivide.md). If the pair filter excludes pairs within a group, triangles of one group count as members of a
// common lower cluster, too.
//
// The sweep needs this as 16 bits per member, the ownership bits, so that one AND decides. If there are up to 16 lower
// clusters, and groups need no bits, their bits are copied from the masks. Otherwise each of them that occurs in the
// leaf gets a bit; in the rare leaf in which more than 16 occur, the remaining ones are looked up in the masks, for
// pairs that the sweep and, for most queries, the first filters have left. Bits that remain are used by
// intersections/vertex_stars.h.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "backends/cpu/stages/subdivide.h"
#include "partition/levels.h"
#include "scene/prepared_scene.h"

namespace crumple::cpu {

class Ownership {
   public:
    /// `above`: levels of subdivision above the scene, if it is a part of a larger one (partition/levels.h).
    Ownership(const PreparedScene& scene, const Levels& above, const Subdivision& subdivision, const Leaf& leaf)
        : scene_(scene) {
        for (const crumple::ClusterLevel& level : above) add_level(level.masks, level.cluster, false);
        add_level(subdivision.mask1.data(), leaf.cluster, false);
        add_level(subdivision.mask2.data(), leaf.child, true);
    }

    /// Writes the ownership bits of the leaf's members to `lower`. `groups_apart`: pairs within a group are excluded;
    /// the bits express this, too, if the leaf has few groups.
    void bits(const std::int32_t* triangle, const std::int32_t* member, std::int64_t n, bool groups_apart,
              std::uint16_t* lower) {
        complete_ = true;
        int lane = 0;
        std::fill(lower, lower + n, std::uint16_t{0});
        // If groups need bits, too, clusters get as few as possible.
        const bool as_they_are = !groups_apart && clusters_ <= 16;
        for (std::size_t l = 0; l < count_; ++l) {
            const ClusterLevel& level = level_[l];
            const std::int32_t* at = level.by_member ? member : triangle;
            if (as_they_are) {
                for (std::int64_t i = 0; i < n; ++i)
                    lower[i] = static_cast<std::uint16_t>(lower[i] | level.of(at[i]) << lane);
                lane += level.clusters;
            } else {
                choose_lanes(level, at, n, lane, lower);
            }
        }
        if (!groups_apart) return;
        const FewGroups groups(scene_, triangle, n, 16 - lane);
        for (std::int64_t i = 0; i < n; ++i)
            lower[i] = static_cast<std::uint16_t>(lower[i] | groups.bit(scene_, triangle[i]) << lane);
    }

    /// True if the bits cover all lower clusters. Otherwise call owns() for each pair of members without a common bit.
    bool complete() const { return complete_; }

    bool owns(std::int32_t triangle_a, std::int32_t member_a, std::int32_t triangle_b, std::int32_t member_b) const {
        for (std::size_t l = 0; l < count_; ++l) {
            const ClusterLevel& level = level_[l];
            const std::uint64_t both =
                level.by_member ? level.of(member_a) & level.of(member_b) : level.of(triangle_a) & level.of(triangle_b);
            if (both != 0) return false;
        }
        return true;
    }

   private:
    /// Memberships in the clusters of a level that are lower than the leaf's own.
    struct ClusterLevel {
        const std::uint64_t* masks;
        int clusters;    ///< number of these clusters
        bool by_member;  ///< true: masks are indexed by member, else by triangle

        std::uint64_t of(std::int32_t i) const { return masks[i] & ((std::uint64_t{1} << clusters) - 1); }
    };

    void add_level(const std::uint64_t* masks, int cluster, bool by_member) {
        if (cluster <= 0) return;  // the cluster is the lowest or, if -1, was not split: there is no lower one
        level_[count_++] = {masks, cluster, by_member};
        clusters_ += cluster;
    }

    // Gives each cluster that occurs in the leaf one of the remaining bits, and sets these bits of the members: eight
    // clusters at a time, by a table from their mask bits to the ownership bits.
    void choose_lanes(const ClusterLevel& level, const std::int32_t* at, std::int64_t n, int& lane,
                      std::uint16_t* lower) {
        std::uint64_t seen = 0;
        for (std::int64_t i = 0; i < n; ++i) seen |= level.of(at[i]);
        for (int shift = 0; seen >> shift != 0; shift += 8) {
            if ((seen >> shift & 255) == 0) continue;
            std::array<std::uint16_t, 256> bits{};
            for (int k = 0; k < 8; ++k) {
                std::uint32_t bit = 0;
                if (seen >> (shift + k) & 1) {
                    if (lane < 16)
                        bit = 1u << lane++;
                    else
                        complete_ = false;
                }
                for (std::size_t m = 0; m < std::size_t{1} << k; ++m)
                    bits[m | std::size_t{1} << k] = static_cast<std::uint16_t>(bits[m] | bit);
            }
            for (std::int64_t i = 0; i < n; ++i)
                lower[i] = static_cast<std::uint16_t>(lower[i] | bits[level.of(at[i]) >> shift & 255]);
            if (shift == 56) break;
        }
    }

    // Groups of a leaf, or none if they do not fit the remaining bits.
    class FewGroups {
       public:
        FewGroups(const PreparedScene& scene, const std::int32_t* triangle, std::int64_t n, int lanes) {
            for (std::int64_t i = 0; i < n; ++i) {
                const std::int32_t group = scene.group(triangle[i]);
                if (count_ > 0 && group == ids_[last_]) continue;
                last_ = find(group);
                if (last_ < count_) continue;
                if (count_ == static_cast<std::size_t>(lanes)) {
                    count_ = 0;
                    return;
                }
                ids_[count_++] = group;
            }
        }
        std::uint32_t bit(const PreparedScene& scene, std::int32_t triangle) const {
            if (count_ == 0) return 0;
            return std::uint32_t{1} << find(scene.group(triangle));
        }

       private:
        std::size_t find(std::int32_t group) const {
            return static_cast<std::size_t>(std::find(ids_.data(), ids_.data() + count_, group) - ids_.data());
        }
        std::array<std::int32_t, 16> ids_{};
        std::size_t count_ = 0, last_ = 0;
    };

    const PreparedScene& scene_;
    std::array<ClusterLevel, max_levels + 2> level_;
    std::size_t count_ = 0;
    int clusters_ = 0;  // number of lower clusters of all levels
    bool complete_ = true;
};

}  // namespace crumple::cpu
