#pragma once

// Public parts of a scene (crumple/part.h): membership of triangles, and the copies that each part owns.

#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/function_ref.h"
#include "crumple/intersections.h"
#include "crumple/part.h"
#include "partition/part_tree.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Members of all parts among some triangles of a scene, sorted by part: the triangles that belong to part k are
/// entries [first[k], first[k + 1]). A triangle may belong to several parts.
struct PartMembers {
    std::vector<std::int64_t> first;     ///< by part: its first entry in `triangle`; then the number of entries
    std::vector<std::int32_t> triangle;  ///< triangles of the scene, ascending within a part
    std::vector<std::uint64_t> masks;    ///< for each member, one per level of the PartTree
};

/// Function that returns the ball that determines a triangle's membership.
using BallOfTriangle = FunctionRef<PartBall(std::int64_t triangle)>;

/// Lists the members of all parts among triangles [begin, end). Calls `ball` for no other triangle.
PartMembers list_members(const PartTree& tree, int parts, BallOfTriangle ball, std::int64_t begin, std::int64_t end);

/// Lists the members of all parts among triangles [0, count) on all threads. Returns one PartMembers for each of
/// several consecutive ranges of triangles.
std::vector<PartMembers> list_members(const PartTree& tree, int parts, BallOfTriangle ball, std::int64_t count,
                                      ParallelFor& parallel);

/// Splits a scene into `count` parts. The result depends on the scene and the count only.
std::vector<Part> make_parts(const PreparedScene& scene, int count, ParallelFor& parallel);

/// Splits a scene by the given balls, instead of balls of the triangles themselves. Calls copy(ids, part) for each
/// part, for different parts at the same time on all threads: `part` has its index and levels already (Part::levels),
/// and copy() adds the triangles `ids`, which ascend.
std::vector<Part> make_parts(const PreparedScene& scene, int count, ParallelFor& parallel, BallOfTriangle ball,
                             FunctionRef<void(std::span<const std::int32_t> ids, Part& part)> copy);

/// Throws Error (invalid_argument) if the part's index, levels, sizes of arrays or ids contradict each other. Checks
/// neither coordinates nor the triangles' corners.
void check_part(const Part& part);

/// Returns the part of one of two meshes alone (`side`: 0 or 1): it owns pairs within that mesh.
Part part_within(const Part& part, int side);

/// Converts pairs from indices of the part's triangles to ids in the meshes.
void name_globally(const Part& part, Array<Pair>& pairs);

}  // namespace crumple
