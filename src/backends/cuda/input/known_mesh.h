#pragma once

// A mesh in device memory whose triangles, and listed edges and points, the host has seen and made features of
// (SceneFeatures). What was seen lies on the device, and is what passes read; each begins by comparing the caller's
// arrays with it. So nothing that they say has to be trusted, nor checked again.

#include <cstdint>

#include "backends/cuda/stages/bounds.h"
#include "backends/device_shape.h"

namespace crumple::cuda {

/// Thrown where the caller's triangles, edges or points turn out to be others.
struct MeshChanged {};

/// Pointers are of the device.
struct KnownMesh {
    const std::int32_t* corners = nullptr;  ///< 3 a triangle, then those of carriers
    std::int64_t faces = 0, carriers = 0;
    const Edge* edges = nullptr;  ///< of the triangles, or as listed
    std::int64_t edge_count = 0;
    const std::int32_t* points = nullptr;  ///< as listed
    std::int64_t point_count = 0;
    std::uint64_t revision = 0;  ///< see SceneFeatures
    friend bool operator==(const KnownMesh&, const KnownMesh&) = default;
};

/// Notes in the counters what of the shape's arrays is not as it is known. Counts are.
void compare(const Geometry& geometry, cudaStream_t stream, const Shape& shape, const KnownMesh& known,
             Counters* counters);

}  // namespace crumple::cuda
