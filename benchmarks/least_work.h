#pragma once

// What each stage of the cuda backend cannot do without: bytes between the device's memory and its processors, and
// nodes of the frame's graph. Together with a device's limits that bounds a stage's time from below (docs/cuda.md).
//
// Bytes: each kernel reads once what it needs of its inputs and writes its outputs once, as the layout has them
// (src/backends/cuda/stages/layout.h), and nothing stays in a cache from one kernel to the next. A gather counts the
// distinct elements, not the 32 bytes that memory hands out for each. Left out is what does not grow with the scene, or
// by a few bytes for each leaf: samples, centres, partial sums, frames, counters; and the few pairs beyond float32.
//
// Nodes: kernels, memsets and copies that wait for each other, by the host's code of each stage. What a frame is: a
// mesh against itself, on the device, with rows of three int32, warm, by default options.

#include <array>
#include <cstdint>

#include "crumple/intersections.h"

namespace crumple::benchmark {

struct Work {
    double bytes = 0;
    int nodes = 0;

    Work& operator+=(const Work& other) {
        bytes += other.bytes;
        nodes += other.nodes;
        return *this;
    }
};

struct LeastWork {
    std::array<Work, stage_count> stage;
    int beside = 0;  ///< nodes that make what guides the next frame: fuzzy C-means and places of each level, frames
    Work frame;      ///< of all stages, and what clears and reads the counters before and after them
};
LeastWork least_work(std::int64_t vertices, bool float32, const Statistics& counted);

}  // namespace crumple::benchmark
