#pragma once

// Steps: a mesh at the two ends of a motion, for queries about features (impacts, proximities, candidates).

#include <string>
#include <vector>

#include "crumple/io.h"

namespace crumple::benchmark {

struct Step {
    std::string name;
    io::TriangleMesh start, end;  ///< the same triangles at the start and at the end of the step
    double radius = 0;            ///< for proximity queries: a quarter of the mean edge length at the start, float32

    VertexView end_view() const { return end.view().vertices; }
};

/// Loads a step. `name` is that of a sequence of two files (sequence.h), whose frames are the step's start and end; or
/// NAME[:TRIANGLES] for a procedural scene. Such a step starts at the scene's last frame but one and goes in the
/// direction of the last frame, so far that vertices move by half the mean edge length on average. So steps of a scene
/// are comparable at all sizes. Throws Error for an unknown name or a missing file.
Step load_step(const std::string& name);

/// Returns the names of steps from files, or of procedural ones if there are no files.
std::vector<std::string> steps();

}  // namespace crumple::benchmark
