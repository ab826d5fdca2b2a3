#pragma once

#include "crumple/function_ref.h"
#include "crumple/impacts.h"
#include "crumple/mesh.h"

namespace crumple {

/// Finds the result of a FreeStepQuery, for a mesh in host memory. `first_impact` and `is_free` ask about a
/// mesh.
void find_free_step(const MeshView& mesh, bool triangle_pairs, FunctionRef<FirstImpact(const MeshView&)> first_impact,
                    FunctionRef<bool(const MeshView&)> is_free, FreeStep& step);

}  // namespace crumple
