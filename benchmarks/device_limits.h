#pragma once

// What a device allows: how many bytes a second, and how long a kernel takes that does nothing.

#include <cuda_runtime.h>

#include <nlohmann/json_fwd.hpp>

namespace crumple::benchmark {

/// Throws std::runtime_error unless `error` is success.
void check(cudaError_t error);

struct DeviceLimits {
    double peak_bandwidth = 0;  ///< bytes a second, by memory clock and bus width; 0: the device does not tell
    double copy_bandwidth = 0;  ///< bytes a second, read and written, that a copy of four times the L2 cache reaches
    // Milliseconds, medians, between events on the stream; of graphs, on one that was kept busy before:
    double graph = 0;   ///< a graph of one empty kernel
    double node = 0;    ///< each further one, in a chain
    double launch = 0;  ///< each further one where they are launched one by one

    double bandwidth() const { return peak_bandwidth > 0 ? peak_bandwidth : copy_bandwidth; }
};

/// Keeps the stream busy for some 50 us, so that the host gives it what follows before the device gets there: between
/// events behind it there is the device's work alone.
void keep_busy(cudaStream_t stream);

/// Of the current device.
DeviceLimits measure_limits(int device);

nlohmann::json to_json(const DeviceLimits& limits);

}  // namespace crumple::benchmark
