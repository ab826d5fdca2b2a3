#pragma once

// Who handles a pair. A leaf owns it iff no lower cluster of any level holds both triangles: no part below the one
// answered, no first-level cluster below k1, no second-level one below k2. Triangles of one group count as members of a
// common lower cluster, too, if only pairs between groups are wanted.
//
// The sweep wants this as 16 bits a member, so that one AND tells. Up to 16 lower clusters are taken from the masks as
// they are; of more, each that occurs in the leaf gets a bit, and in the rare leaf that meets more than 16 the rest is
// looked up in the masks for pairs that passed the filters.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "engine/cpu/subdivide.h"
#include "model/scene.h"

namespace crumple::cpu {

class Ownership {
   public:
    Ownership(const Scene& scene, const Subdivision& subdivision, const std::uint64_t* part_masks, int part,
              const Leaf& leaf)
        : scene_(scene),
          subdivision_(subdivision),
          part_masks_(part_masks),
          parts_(part_masks ? part : 0),
          clusters_(leaf.cluster),
          children_(leaf.child < 0 ? 0 : leaf.child) {}

    /// Ownership bits for the members of the leaf, written to `lower`. `groups_apart`: pairs of one group are unwanted;
    /// the bits say so, too, where the leaf's groups are few.
    void bits(const std::int32_t* triangle, const std::int32_t* member, std::int64_t n, bool groups_apart,
              std::uint16_t* lower) {
        complete_ = true;
        // Groups need lanes too, so clusters leave them all they can.
        if (!groups_apart && parts_ + clusters_ + children_ <= 16) {
            for (std::int64_t i = 0; i < n; ++i)
                lower[i] = static_cast<std::uint16_t>(part_mask(triangle[i]) | cluster_mask(triangle[i]) << parts_ |
                                                      child_mask(member[i]) << (parts_ + clusters_));
            return;
        }
        int lane = 0;
        std::fill(lower, lower + n, std::uint16_t{0});
        if (parts_) add_level(n, lane, lower, [&](std::int64_t i) { return part_mask(triangle[i]); });
        if (clusters_) add_level(n, lane, lower, [&](std::int64_t i) { return cluster_mask(triangle[i]); });
        if (children_) add_level(n, lane, lower, [&](std::int64_t i) { return child_mask(member[i]); });
        if (!groups_apart) return;
        const FewGroups groups(scene_, triangle, n, 16 - lane);
        for (std::int64_t i = 0; i < n; ++i)
            lower[i] = static_cast<std::uint16_t>(lower[i] | groups.bit(scene_, triangle[i]) << lane);
    }

    /// The bits say everything; otherwise ask `owns` about each pair that passed them.
    bool complete() const { return complete_; }

    bool owns(std::int32_t triangle_a, std::int32_t member_a, std::int32_t triangle_b, std::int32_t member_b) const {
        return ((part_mask(triangle_a) & part_mask(triangle_b)) |
                (cluster_mask(triangle_a) & cluster_mask(triangle_b)) |
                (child_mask(member_a) & child_mask(member_b))) == 0;
    }

   private:
    // Gives each cluster that occurs in mask_of(i) one of the lanes that are left, and members their bits: eight
    // clusters at a time, by a table of what their bits become.
    template <class MaskOf>
    void add_level(std::int64_t n, int& lane, std::uint16_t* lower, MaskOf mask_of) {
        std::uint64_t seen = 0;
        for (std::int64_t i = 0; i < n; ++i) seen |= mask_of(i);
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
                lower[i] = static_cast<std::uint16_t>(lower[i] | bits[mask_of(i) >> shift & 255]);
            if (shift == 56) break;
        }
    }

    // The groups of a leaf, if they fit the lanes that are left.
    class FewGroups {
       public:
        FewGroups(const Scene& scene, const std::int32_t* triangle, std::int64_t n, int lanes) {
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
        std::uint32_t bit(const Scene& scene, std::int32_t triangle) const {
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

    static std::uint64_t below(int k) { return (std::uint64_t{1} << k) - 1; }

    // Memberships in lower parts, lower clusters of the first level, lower ones of the second.
    std::uint64_t part_mask(std::int32_t triangle) const { return parts_ ? part_masks_[triangle] & below(parts_) : 0; }
    std::uint64_t cluster_mask(std::int32_t triangle) const {
        return subdivision_.mask1[static_cast<std::size_t>(triangle)] & below(clusters_);
    }
    std::uint64_t child_mask(std::int32_t member) const {
        return children_ ? subdivision_.mask2[static_cast<std::size_t>(member)] & below(children_) : 0;
    }

    const Scene& scene_;
    const Subdivision& subdivision_;
    const std::uint64_t* part_masks_;
    int parts_, clusters_, children_;  // how many are lower than the leaf's own
    bool complete_ = true;
};

}  // namespace crumple::cpu
