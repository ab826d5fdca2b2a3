#pragma once

// Common part of the functions of the runtime API: only one host thread at a time runs any of them; they fail if there
// is no device, and store errors for cudaGetLastError.

#include <mutex>

#include "cuda_on_cpu/machine/settings.h"
#include "cuda_on_cpu/machine/stream.h"

namespace cuda_on_cpu {

/// State of a host thread: last error, current device, and capture mode (cudaThreadExchangeStreamCaptureMode).
struct HostThread {
    cudaError_t last_error = cudaSuccess;
    int device = 0;
    cudaStreamCaptureMode capture_mode = cudaStreamCaptureModeGlobal;
};
HostThread& host_thread();

/// Returns the error of a call without a working device; cudaSuccess if there is one.
inline cudaError_t device_missing() {
    if (!settings().driver) return cudaErrorInsufficientDriver;
    return settings().devices < 1 ? cudaErrorNoDevice : settings().broken;
}

inline cudaError_t keep(cudaError_t error) {
    if (error != cudaSuccess) host_thread().last_error = error;
    return error;
}

template <class F>
cudaError_t call(F f) {
    const std::lock_guard lock(machine_mutex());
    if (const cudaError_t error = device_missing()) return keep(error);
    return keep(f());
}

}  // namespace cuda_on_cpu
