#pragma once

// A device that computes wrong results is found before it is used: small cases, which need every path of the exact
// arithmetic, are decided on it by the kernels that decide, and compared with the host's results bit for bit. Compilers
// have been at fault there (docs/nvcc_13_0.md).

#include <string>

#include "engine/cuda/device.h"
#include "engine/cuda/runtime.h"

namespace crumple::cuda {

/// Describes the first result that differs; empty if none does. Cost: eight kernels, an upload and a download of 100
/// KB.
std::string find_difference_from_host(const Device& device, cudaStream_t stream);

/// Throws Error (backend_unavailable) if the device's results differ. Compares once per device and process.
void check_known_answers(const Device& device, cudaStream_t stream);

/// Makes the next check compare again. For tests.
void forget_known_answers();

}  // namespace crumple::cuda
