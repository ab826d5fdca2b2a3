#pragma once

// Meshes of the device, copied to the host.

#include "backends/cuda/device/runtime.h"
#include "backends/device_shape.h"
#include "crumple/mesh.h"

namespace crumple::cuda {

/// Done when it returns. Rows keep their strides, so what lies between them comes along.
void copy_to_host(const Shape& device, Copied what, cudaStream_t stream, HostShape& host);

}  // namespace crumple::cuda
