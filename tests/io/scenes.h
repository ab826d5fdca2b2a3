#pragma once

// Functions that read glTF scenes by read_world.

#include <sstream>

#include "files.h"
#include "gltf_scene.h"

namespace crumple::io::test {

using crumple::test::GltfScene;

inline WorldMesh read_scene(const std::string& glb, const ReadOptions& options = {}) {
    std::istringstream in(glb);
    return read_world(in, "a.glb", options);
}
inline WorldMesh read_scene(const GltfScene& scene, const ReadOptions& options = {}) {
    return read_scene(scene.glb(), options);
}

/// Expects an error of format that names the file and says `what`.
inline void expect_refused(const GltfScene& scene, const std::string& what) {
    const Error error = error_of([&] { read_scene(scene); });
    EXPECT_EQ(error.code, ErrorCode::format) << error.what();
    EXPECT_TRUE(contains(error.what(), "a.glb: ")) << error.what();
    EXPECT_TRUE(contains(error.what(), what)) << error.what();
}

}  // namespace crumple::io::test
