#pragma once

// Meshes that move: the frames of an animation, in order.

#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::benchmark {

struct Sequence {
    std::string name;
    std::vector<int> numbers;  ///< numbers of the frames in their source
    std::vector<io::TriangleMesh> frames;
};

/// Loads every `step`-th frame of a sequence. It is named NAME[:TRIANGLES]: a file sequence, or a procedural scene that
/// moves, by its name and size as in workload.h. Throws Error for an unknown name or a missing file.
Sequence load_sequence(const std::string& name, int step = 1);

/// Returns the names of all available sequences: those from files, then every procedural scene that moves.
std::vector<std::string> sequences();

}  // namespace crumple::benchmark
