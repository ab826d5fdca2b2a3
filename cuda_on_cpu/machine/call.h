#pragma once

// What every function of the runtime API has in common: one host thread at a time, no device is an error, and errors
// are kept for cudaGetLastError.

#include <mutex>

#include "cuda_on_cpu/machine/settings.h"
#include "cuda_on_cpu/machine/stream.h"

namespace cuda_on_cpu {

/// The calling thread's last error, current device, and how far it respects captures.
struct HostThread {
    cudaError_t last_error = cudaSuccess;
    int device = 0;
    cudaStreamCaptureMode capture_mode = cudaStreamCaptureModeGlobal;
};
HostThread& host_thread();

/// Why there is no device to call, or cudaSuccess.
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
