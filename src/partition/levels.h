#pragma once

// Levels of subdivision above a backend's own, for a scene that is one cluster of a larger scene.
//
// A cluster owns a pair of triangles iff, at every level, it (or the cluster that contains it there) is the lowest
// cluster that both triangles belong to (docs/subdivide.md). So each level has one mask for each triangle. Labels of
// triangles (world, body, rank) are a level, too, but the sets of triangles with one label do not overlap: two
// triangles are in at most one common set, which owns their pair. Such a level needs no entry here.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "crumple/part.h"

namespace crumple {

inline constexpr std::size_t max_levels = 4;

struct ClusterLevel {
    const std::uint64_t* masks = nullptr;  ///< 1 per triangle of the scene: bit k is set if it belongs to cluster k
    int cluster = 0;                       ///< index of the cluster of this level that is this scene, or contains it
};

/// Short list of levels, from the top; empty for a scene that is not part of another.
class Levels {
   public:
    Levels() = default;
    /// Constructs the levels of a part, which must outlive this object; none for null.
    explicit Levels(const Part* part) {
        if (!part) return;
        for (const PartLevel& level : part->levels) level_[count_++] = {level.masks.data(), level.cluster};
    }
    void add(const ClusterLevel& level) { level_[count_++] = level; }
    const ClusterLevel* begin() const { return level_.data(); }
    const ClusterLevel* end() const { return level_.data() + count_; }

    /// True if this scene owns the pair of triangles a and b: on all levels, its cluster is the lowest that both belong
    /// to.
    bool own(std::int64_t a, std::int64_t b) const {
        for (const ClusterLevel& level : *this)
            if (std::countr_zero(level.masks[a] & level.masks[b]) != level.cluster) return false;
        return true;
    }

   private:
    std::array<ClusterLevel, max_levels> level_;
    std::size_t count_ = 0;
};

}  // namespace crumple
