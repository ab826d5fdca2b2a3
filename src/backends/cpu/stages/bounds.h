#pragma once

// Stage `bounds`: normalised vertices, and a ball around each triangle: its centroid and the largest distance from
// there to a corner ([MZ] eq. 5, but one for each triangle).
//
// Centroid and radius are float32; the radius is widened so that the ball about the rounded centroid holds the
// triangle.

#include "backends/cpu/parallel.h"
#include "backends/cpu/stages/kernels.h"
#include "backends/cpu/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cpu {

/// Of a scene that moves, balls hold the triangle all the way. Returns whether a triangle names a vertex twice.
bool compute_bounds(const PreparedScene& scene, const Inflation& inflation, const StageKernels& kernels,
                    Workers& workers, Points& points, Array<Ball>& balls);

/// Between two meshes: included[t] is whether the triangle's ball reaches the other mesh's box. Others cannot collide.
void exclude_far(const PreparedScene& scene, Workers& workers, const Array<Ball>& balls, Array<std::uint8_t>& included);

}  // namespace crumple::cpu
