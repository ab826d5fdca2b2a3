#pragma once

// Rows of stencils (crumple/stencils.h) from lists of pairs.

#include "base/parallel_for.h"
#include "crumple/stencils.h"
#include "results/stencil_scene.h"

namespace crumple {

/// Make stencils(). `workers` run chunks of pairs. Throw Error if the result does not fit the scene.
/// @{
Stencils make_stencils(const StencilScene& scene, const Proximities& found, const StencilOptions& options,
                       ParallelFor& workers);
Stencils make_stencils(const StencilScene& scene, const Impacts& found, const StencilOptions& options,
                       ParallelFor& workers);
/// @}

}  // namespace crumple
