#pragma once

#include <cstdint>

#include "scenes/soup.h"

namespace crumple::scenes {

inline constexpr int cloth_frames = 94;

/// The scene `cloth`: adds the sheet as group 0 and the ball as group 1.
void add_cloth(Soup& soup, const Parameters& parameters);

/// Some of a scene's triangles, which follow those of the blocks before, and all vertices that they name, which follow
/// each other in the scene.
struct MeshBlock {
    io::TriangleMesh mesh;
    std::int64_t first_vertex = 0;  ///< in the scene
};

/// One of `blocks` blocks of the scene `cloth`, made without the others. `parameters.triangles` are the scene's.
MeshBlock cloth_block(const Parameters& parameters, int block, int blocks);

}  // namespace crumple::scenes
