#pragma once

// Depths of the vertices of one surface inside another: their distances to the other surface (docs/overlap.md).

#include <cstdint>
#include <vector>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "results/overlap_output.h"
#include "search/overlap/overlap_windings.h"
#include "search/walks/point_walk.h"

namespace crumple {

/// Returns the depths of all vertices of `of` at which the winding number of `other` is not 0, sorted by vertex, in
/// units of length. Leaves out vertices that lie on `other`. `windings`: the intervals of `of`; any shift gives the
/// same result. All finite coordinates are valid. Adds to `rational` the number of vertices that took rational
/// arithmetic. Cost: two to three microseconds for each vertex and 100,000 triangles; some microseconds for each
/// closest triangle if rational arithmetic is needed, as it is for exact ties. The result does not depend on the number
/// of threads.
std::vector<VertexDepth> find_depths(const PlacedSurface& of, const WindingSteps& windings, const SurfaceTree& other,
                                     ParallelFor& workers, Cancellation& cancellation, std::int64_t& rational);

}  // namespace crumple
