#pragma once

// A lower bound on the number of pairs, for scenes whose answer is too large for a memory limit: duplicated faces, by
// index or by position, each of which collides with every other one.

#include <cstdint>

#include "crumple/array.h"
#include "crumple/options.h"
#include "model/rules.h"
#include "model/scene.h"

namespace crumple {

/// At least so many pairs are found among the triangles whose lowest bit in `part_masks` is `part`, or among all if
/// that is null: those of triangles at equal positions. O(triangles); 0 if there is no memory for it.
std::int64_t count_duplicates(const Scene& scene, const Query& query, const GroupRule& rule,
                              const std::uint64_t* part_masks, int part, MemoryMeter* meter);

}  // namespace crumple
