#pragma once

// Lower bounds on the work of each stage of the cuda backend: bytes between the device's memory and its processors, and
// nodes of the frame's graph. Together with a device's limits they bound a stage's time from below (docs/cuda.md).
//
// Bytes: each kernel reads the needed part of its inputs once and writes its outputs once, in the layout of
// src/backends/cuda/stages/layout.h, and nothing stays in a cache from one kernel to the next. A gather counts the
// distinct elements, not the 32 bytes that memory transfers for each. Data that do not grow with the scene, or by a few
// bytes per leaf, are left out: samples, centres, partial sums, frames, counters; so are the few pairs that float32
// filters leave unresolved.
//
// Nodes: kernels, memsets and copies that wait for each other, by the host's code of each stage. A frame is a mesh
// against itself, on the device, with rows of three int32, warm-started, with default options.

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
    int beside = 0;  ///< nodes that warm-start the next frame: fuzzy C-means and places of each level, frames
    Work frame;      ///< all stages, and counters cleared and read before and after them
};
LeastWork least_work(std::int64_t vertices, bool float32, const Statistics& counted);

}  // namespace crumple::benchmark
