#pragma once

// A mesh that moves for one step, for the questions about features: what touches what on the way, what is near what.

#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::benchmark {

struct Step {
    std::string name;
    io::TriangleMesh start, end;  ///< of the same triangles
    double radius = 0;            ///< to ask with what is near: a quarter of the mean edge length at the start, float32

    VertexView end_view() const { return end.view().vertices; }
};

/// The two frames of a sequence of files, by its name (sequence.h), or a procedural scene, NAME[:TRIANGLES]: from its
/// last frame but one in the direction of the last, so far that a vertex moves half an edge's length on average. So
/// steps of one scene are alike at all sizes. Throws Error for a name that is unknown or a file that is not there.
Step load_step(const std::string& name);

/// Names of steps from files; procedural ones if there are no files.
std::vector<std::string> steps();

}  // namespace crumple::benchmark
