#pragma once

// The public parts of a scene (crumple/part.h): who belongs to which, and the copies that each part owns.

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

/// Members of the parts among some triangles, part by part: those of part k lie at [first[k], first[k + 1]).
struct PartMembers {
    std::vector<std::int64_t> first;     ///< parts + 1
    std::vector<std::int32_t> triangle;  ///< of the scene, ascending within a part
    std::vector<std::uint64_t> masks;    ///< one a level for each member
};

/// What membership knows of a triangle.
using BallOfTriangle = FunctionRef<PartBall(std::int64_t triangle)>;

/// Members among triangles [begin, end). Looks at no other triangle: the tree knows all else.
PartMembers list_members(const PartTree& tree, int parts, BallOfTriangle ball, std::int64_t begin, std::int64_t end);

/// The same of triangles [0, count), on all threads: slice by slice, each of which ends where the next begins.
std::vector<PartMembers> list_members(const PartTree& tree, int parts, BallOfTriangle ball, std::int64_t count,
                                      ParallelFor& parallel);

/// Cuts a scene into `count` parts; depends only on the scene and the count.
std::vector<Part> make_parts(const PreparedScene& scene, int count, ParallelFor& parallel);

/// The same where triangles belong to parts by other balls. copy(ids, part) copies the triangles of these ids,
/// ascending, into a part that has its levels; on all threads.
std::vector<Part> make_parts(const PreparedScene& scene, int count, ParallelFor& parallel, BallOfTriangle ball,
                             FunctionRef<void(std::span<const std::int32_t> ids, Part& part)> copy);

/// Throws Error (invalid_argument) if the part is none that make_parts() could have made, as far as that shows without
/// a look at its vertices.
void check_part(const Part& part);

/// From positions in the part's lists of triangles to ids in the meshes.
void name_globally(const Part& part, Array<Pair>& pairs);

}  // namespace crumple
