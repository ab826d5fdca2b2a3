#pragma once

// Lower bounds on the work of each stage of the cuda backend: bytes between the device's memory and its processors, and
// nodes of the frame's graph. Together with a device's limits they bound a stage's time from below (docs/cuda.md).
//
// Bytes: each kernel reads the needed part of its inputs once and writes its outputs once, in the layout of
// src/backends/cuda/stages/layout.h, and nothing stays in a cache from one kernel to the next. For gathers, the bytes
// of the distinct elements count, not the 32 bytes that memory transfers for each. Data are left out whose size does
// not depend on the scene, or is a few bytes per leaf: samples, centres, partial sums, frames, counters. So are the few
// pairs that float32 filters leave unresolved.
//
// Nodes: kernels, memsets and copies of which each waits for the one before, counted in the host's code of each stage.
// The bounds are for a search of one mesh against itself, on the device, with default options and warm-started
// clusters, whose triangles are contiguous rows of three int32.

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
    /// Number of nodes in parallel branches of the graph. They prepare the next frame: the centres of clusters of each
    /// level (fuzzy C-means), and the leaves' frames.
    int beside = 0;
    Work frame;  ///< sum over all stages and the batched clear of counters, which precedes them
};
LeastWork least_work(std::int64_t vertices, bool float32, const Statistics& counted);

}  // namespace crumple::benchmark
