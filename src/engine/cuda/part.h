#pragma once

// Public parts of meshes that lie on the device; the same parts as on the host (model/part.h).

#include <vector>

#include "engine/cuda/input.h"

namespace crumple::cuda {

/// Parts of the meshes that `input` views. Centres are placed by the host, from 4,096 triangles at most; members are
/// found on the device.
std::vector<Part> make_parts(const Geometry& geometry, cudaStream_t stream, Input& input, MemoryMeter& meter,
                             int count);

}  // namespace crumple::cuda
