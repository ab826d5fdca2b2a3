#pragma once

// Known-answer test, run before a device is used: the kernels that decide exactly evaluate small cases that cover every
// path of the exact arithmetic for pairs of triangles, vertex-face and edge-edge pairs, and their results are compared
// bit for bit with the host's. It detects miscompiled kernels (docs/nvcc_13_0.md).

#include <string>

#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/runtime.h"

namespace crumple::cuda {

/// Returns a description of the first result that differs from the host's, or an empty string. Cost: nine launches,
/// one upload and one download, each of about 100 KB.
std::string find_difference_from_host(const Device& device, cudaStream_t stream);

/// Throws Error (backend_unavailable) if the device's results differ. Compares once per device and process; later calls
/// reuse the outcome.
void check_comparison_cases(const Device& device, cudaStream_t stream);

/// Makes the next check compare again. For tests.
void reset_comparison_cases();

}  // namespace crumple::cuda
