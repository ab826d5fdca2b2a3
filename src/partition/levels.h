#pragma once

// Levels of subdivision above an engine's own: where a scene is one cluster of a larger one.
//
// A cluster handles a pair iff it is the lowest one of its level that both triangles belong to, at every level
// (docs/subdivide.md), so each level brings one mask for each triangle. What a triangle is given as a label (a world, a
// body, a rank) is a level, too, but one whose clusters do not overlap: being a member decides, and nothing is left to
// ask. Such a level needs no entry here.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "crumple/part.h"

namespace crumple {

inline constexpr std::size_t max_levels = 4;

struct Level {
    const std::uint64_t* masks = nullptr;  ///< by triangle of the scene: bit k, it belongs to cluster k
    int cluster = 0;                       ///< the one that the scene is
};

/// A short list, from the top; empty for a scene that is no part of another.
class Levels {
   public:
    Levels() = default;
    /// Those of a part, which must outlive this; none for null.
    explicit Levels(const Part* part) {
        if (!part) return;
        for (const PartLevel& level : part->levels) level_[count_++] = {level.masks.data(), level.cluster};
    }
    void add(const Level& level) { level_[count_++] = level; }
    const Level* begin() const { return level_.data(); }
    const Level* end() const { return level_.data() + count_; }

    /// Whether the scene is the lowest cluster that both triangles belong to, on all levels.
    bool own(std::int64_t a, std::int64_t b) const {
        for (const Level& level : *this)
            if (std::countr_zero(level.masks[a] & level.masks[b]) != level.cluster) return false;
        return true;
    }

   private:
    std::array<Level, max_levels> level_;
    std::size_t count_ = 0;
};

}  // namespace crumple
