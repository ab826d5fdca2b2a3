#pragma once

#include "scenes/scenes.h"

namespace crumple::test {

/// Returns a frame of the scene "cloth" with about `triangles` triangles.
inline io::TriangleMesh cloth(int triangles, int frame = 40) {
    return scenes::make("cloth", {.triangles = triangles, .frame = frame});
}

}  // namespace crumple::test
