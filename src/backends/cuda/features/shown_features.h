#pragma once

// What results about features and candidates on the device have in common.

#include <array>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/known_mesh.h"
#include "backends/cuda/stages/layout.h"
#include "queries/device_answer.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Where the lists of each kind end, among all rows: offsets at the first features of each kind.
template <std::size_t n>
void copy_ends(cudaStream_t stream, const unsigned long long* offsets, const std::uint32_t (&base)[n],
               std::array<unsigned long long, n>& ends) {
    for (std::size_t k = 0; k < n; ++k)
        CRUMPLE_CUDA(cudaMemcpyAsync(&ends[k], offsets + base[k], sizeof ends[k], cudaMemcpyDeviceToHost, stream));
    CRUMPLE_CUDA(cudaStreamSynchronize(stream));
}

/// A result with so many rows, whose lists are still to be named.
inline DeviceAnswer shown_answer(const KnownMesh& known, unsigned long long rows, const Statistics& statistics) {
    DeviceAnswer shown;
    shown.rows_needed = shown.count = static_cast<std::int64_t>(rows);
    shown.edges = known.edges;
    shown.edge_count = known.edge_count;
    shown.statistics = statistics;
    return shown;
}

/// Result of an incomplete replay.
inline DeviceAnswer incomplete_answer(const Counters& counters) {
    DeviceAnswer shown;
    shown.complete = false;
    shown.rows_needed = static_cast<std::int64_t>(counters.hits);
    shown.statistics.backend = "cuda";
    return shown;
}

inline void count_feature_tests(const Counters& c, Statistics& s) {
    s.edge_tests += static_cast<std::int64_t>(c.listed);
    for (const unsigned long long tests : c.tests) {
        s.double_tests += static_cast<std::int64_t>(tests);
        s.exact_tests += static_cast<std::int64_t>(tests);
    }
}

}  // namespace crumple::cuda
