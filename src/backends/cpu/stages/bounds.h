#pragma once

// Stage `bounds`: normalised vertices, and a ball around each triangle: its centroid, and the largest distance from
// there to a corner (eq. 5 of [MZ], the paper cited in ARCHITECTURE.md, but per triangle). If the scene moves, the
// corners at the start and at the end count. The radius grows by the inflation of the query (geometry/inflation.h). For
// candidates, the ball is that around the triangle's inflated box.
//
// Centre and radius are float32; the radius is widened to cover rounding errors, those of the centre included.

#include "backends/cpu/parallel.h"
#include "backends/cpu/stages/kernels.h"
#include "backends/cpu/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cpu {

/// Computes normalised vertices and balls. Returns true if a triangle has a repeated vertex.
bool compute_bounds(const PreparedScene& scene, const Inflation& inflation, const StageKernels& kernels,
                    Workers& workers, Points& points, Array<Ball>& balls);

/// For two meshes: sets included[t] to 1 if the triangle's ball reaches the other mesh's box, else to 0. Excluded
/// triangles cannot collide.
void exclude_far(const PreparedScene& scene, Workers& workers, const Array<Ball>& balls, Array<std::uint8_t>& included);

}  // namespace crumple::cpu
