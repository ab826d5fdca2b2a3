#pragma once

#include <cstdint>

#include "scenes/soup.h"

namespace crumple::scenes {

inline constexpr int cloth_frames = 94;

/// Adds the scene `cloth` to a soup: the sheet as group 0, the ball as group 1.
void add_cloth(Soup& soup, const Parameters& parameters);

/// Consecutive triangles of a scene, and the range of its vertices that they use.
struct MeshBlock {
    io::TriangleMesh mesh;
    std::int64_t first_vertex = 0;  ///< index in the scene
};

/// Makes one of `blocks` blocks of the scene `cloth` without making the others. `parameters.triangles`: number of
/// triangles of the whole scene.
MeshBlock cloth_block(const Parameters& parameters, int block, int blocks);

}  // namespace crumple::scenes
