#pragma once

// Meshes that move: the frames of an animation, in order.

#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::benchmark {

struct Sequence {
    std::string name;
    std::vector<int> numbers;  ///< number of each frame in the animation that it was taken from
    std::vector<io::TriangleMesh> frames;
};

/// Loads every `step`-th frame of a sequence, or both frames of an unc_... sequence, which has only two. `name` is that
/// of a sequence of files, or NAME[:TRIANGLES] for a procedural scene that moves, as in workload.h. Throws Error for an
/// unknown name or a missing file.
Sequence load_sequence(const std::string& name, int step = 1);

/// Returns the names of all available sequences: those from files, then every procedural scene that moves.
std::vector<std::string> sequences();

}  // namespace crumple::benchmark
