#pragma once

// Limits of a device: memory bandwidth, and the time of a kernel that does nothing.

#include <cuda_runtime.h>

#include <nlohmann/json_fwd.hpp>

namespace crumple::benchmark {

/// Throws std::runtime_error unless `error` is success.
void check(cudaError_t error);

struct DeviceLimits {
    double peak_bandwidth =
        0;  ///< bytes per second, by memory clock and bus width; 0 if the device does not report them
    double copy_bandwidth = 0;  ///< bytes per second, read and written, of a copy of four times the L2 cache
    // Median milliseconds between events on the stream; for graphs, on a stream that is kept busy before:
    double graph = 0;   ///< a graph of one empty kernel
    double node = 0;    ///< each further kernel of the graph, in a chain
    double launch = 0;  ///< each further kernel where they are launched one by one

    double bandwidth() const { return peak_bandwidth > 0 ? peak_bandwidth : copy_bandwidth; }
};

/// Keeps the stream busy for some 50 us, so that the host enqueues the following work before the device reaches it.
/// Events that are recorded after this call then measure only the device's work.
void keep_busy(cudaStream_t stream);

/// Measures the limits of `device`, which must be the current one.
DeviceLimits measure_limits(int device);

nlohmann::json to_json(const DeviceLimits& limits);

}  // namespace crumple::benchmark
