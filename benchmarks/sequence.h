#pragma once

// Meshes that move: the frames of an animation, in order.

#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::benchmark {

struct Sequence {
    std::string name;
    std::vector<int> numbers;  ///< of the frames, as their source counts them
    std::vector<io::TriangleMesh> frames;
};

/// A sequence is named NAME[:TRIANGLES]: a file sequence, or a procedural scene that moves, by its name and size as in
/// workload.h. Every `step`-th frame is taken. Throws Error for a name that is unknown or a file that is not there.
Sequence load_sequence(const std::string& name, int step = 1);

/// Names of all sequences that are here: those from files, then every procedural scene that moves.
std::vector<std::string> sequences();

}  // namespace crumple::benchmark
