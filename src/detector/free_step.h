#pragma once

#include <stop_token>

#include "crumple/detector.h"

namespace crumple {

/// Detector::find_free_step, of a mesh on the host.
FreeStep free_step(Detector& detector, const MeshView& mesh, const VertexView& end, const Motion& question,
                   const std::stop_token& stop);

}  // namespace crumple
