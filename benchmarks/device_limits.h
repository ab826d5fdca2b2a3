#pragma once

// Limits of a device: memory bandwidth, and the time of a kernel that does nothing.

#include <cuda_runtime.h>

#include <nlohmann/json_fwd.hpp>

namespace crumple::benchmark {

/// Throws std::runtime_error unless `error` is success.
void check(cudaError_t error);

struct DeviceLimits {
    /// Bytes per second that memory clock and bus width allow; 0 if the device does not report these.
    double peak_bandwidth = 0;
    /// Bytes read and written per second while the device copies an array four times as large as its L2 cache.
    double copy_bandwidth = 0;
    // Median milliseconds between events on the stream; for graphs, on a stream that is kept busy before:
    double graph = 0;   ///< time of a graph of one empty kernel
    double node = 0;    ///< additional time of each further kernel of the graph, in a chain
    double launch = 0;  ///< additional time of each further kernel if kernels are launched one by one

    double bandwidth() const { return peak_bandwidth > 0 ? peak_bandwidth : copy_bandwidth; }
};

/// Keeps the stream busy for some 50 us, so that the host enqueues the following work before the device reaches it.
/// Events that are recorded after this call then measure only the device's work.
void keep_busy(cudaStream_t stream);

/// Measures the limits of `device`, which must be the current one.
DeviceLimits measure_limits(int device);

nlohmann::json to_json(const DeviceLimits& limits);

}  // namespace crumple::benchmark
