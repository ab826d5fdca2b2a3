#pragma once

#include "scenes/scenes.h"

namespace crumple::test {

inline io::TriangleMesh cloth(int triangles, int frame = 40) {
    return scenes::make("cloth", {.triangles = triangles, .frame = frame});
}

}  // namespace crumple::test
