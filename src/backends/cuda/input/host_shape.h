#pragma once

// Download of meshes from the device.

#include "backends/cuda/device/runtime.h"
#include "backends/device_shape.h"
#include "crumple/mesh.h"

namespace crumple::cuda {

/// Copies a shape to the host, and returns once the copies are complete. Rows keep their strides, so bytes between rows
/// are copied, too.
void copy_to_host(const Shape& device, Copied what, cudaStream_t stream, HostShape& host);

}  // namespace crumple::cuda
