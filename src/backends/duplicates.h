#pragma once

// A lower bound on the number of pairs, for scenes whose answer is too large for a memory limit: duplicated faces, by
// index or by position, each of which collides with every other one.

#include <cstdint>

#include "crumple/array.h"
#include "crumple/options.h"
#include "partition/levels.h"
#include "scene/rules.h"
#include "scene/scene.h"

namespace crumple {

/// At least so many pairs are found: those of triangles at equal positions. Of a scene that is a part, `levels` are
/// above it, and triangles count that belong to no lower part. O(triangles); 0 if there is no memory for it.
std::int64_t count_duplicates(const Scene& scene, const Query& query, const GroupRule& rule, const Levels& levels,
                              MemoryMeter* meter);

}  // namespace crumple
