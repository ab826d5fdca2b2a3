#pragma once

// Shortens a step until nothing touches: finds the impacts, cuts the shares of the step that the bodies or vertices
// take, and repeats with the rounded end positions.

#include "crumple/function_ref.h"
#include "crumple/impacts.h"
#include "crumple/scene.h"

namespace crumple {

/// Finds the result of a FreeStepQuery for a mesh, two meshes or a world in host memory. `find` finds impacts; its
/// results are valid until it is called again.
void find_free_step(const Scene& scene, const FreeStepQuery& query,
                    FunctionRef<const Impacts&(const Scene&, const ImpactQuery&)> find, FreeStep& step);

}  // namespace crumple
