#pragma once

// Functions that read bytes as if they were the contents of a file called `name`.

#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "crumple/io.h"

namespace crumple::fuzz {

inline io::TriangleMesh read_mesh(std::string_view bytes, const std::string& name, const io::ReadOptions& options) {
    std::istringstream in{std::string(bytes)};
    return io::read_mesh(in, name, options);
}

inline io::WorldMesh read_world(std::string_view bytes, const std::string& name, const io::ReadOptions& options) {
    std::istringstream in{std::string(bytes)};
    return io::read_world(in, name, options);
}

inline std::vector<Pose> read_poses(std::string_view bytes, const std::string& name,
                                    std::span<const std::string> bodies) {
    std::istringstream in{std::string(bytes)};
    return io::read_poses(in, name, bodies);
}

inline std::vector<Pair> read_pairs(std::string_view bytes, const std::string& name) {
    std::istringstream in{std::string(bytes)};
    return io::read_pairs(in, name);
}

}  // namespace crumple::fuzz
