#pragma once

// Members of a leaf (small set of triangles that one sweep searches), from `subdivide` to `sort`.

#include "backends/cpu/stages/layout.h"
#include "backends/cpu/stages/subdivide.h"
#include "scene/prepared_scene.h"

namespace crumple::cpu {

struct LeafMembers {
    explicit LeafMembers(MemoryMeter* m) : boxes(m), triangle(m), member(m), lower(m) {}
    Boxes boxes;
    Array<std::int32_t> triangle;  ///< id in the scene; the last one is repeated `padding` times
    Array<std::int32_t> member;    ///< position in the member arrays of Subdivision (subdivide.h)
    Array<std::uint16_t> lower;    ///< ownership bits (ownership.h)
    /// True if `lower` does not cover all lower clusters, so that `narrow` needs SortedLeaf::member.
    bool keep_members = true;
    LeafBounds bounds;
    bool between = false;         ///< true for two meshes: only pairs across them are searched
    std::int64_t first_side = 0;  ///< number of members of the first mesh, which come first

    std::int64_t size() const { return static_cast<std::int64_t>(member.size()); }

    void reserve(std::size_t n);

    /// Lists the leaf's members, in ascending order of triangles, and reserves the arrays that the next stages write.
    void gather(const PreparedScene& scene, const Subdivision& subdivision, const Leaf& leaf);
};

}  // namespace crumple::cpu
