#pragma once

// Cached mesh in device memory. The host has downloaded and validated the caller's triangles, and lists of edges and
// points, once, and has made features of them (SceneFeatures). Passes read a copy on the device, and each begins by
// comparing the caller's arrays with this copy. So the caller's arrays need not be trusted, nor validated again.

#include <cstdint>

#include "backends/cuda/stages/bounds.h"
#include "backends/device_shape.h"

namespace crumple::cuda {

/// Thrown if the caller's triangles, edges or points differ from the cached ones.
struct MeshChanged {};

/// Corners, edges and points of a cached mesh. Pointers refer to device memory.
struct CachedMesh {
    const std::int32_t* corners = nullptr;  ///< 3 per triangle, then 3 per proxy triangle: a degenerate triangle for an
                                            ///< edge or a point that no triangle can own
    std::int64_t faces = 0, proxies = 0;
    const Edge* edges = nullptr;  ///< the caller's list, or else those of the triangles
    std::int64_t edge_count = 0;
    const std::int32_t* points = nullptr;  ///< the caller's list
    std::int64_t point_count = 0;
    std::uint64_t revision = 0;  ///< see SceneFeatures
    friend bool operator==(const CachedMesh&, const CachedMesh&) = default;
};

/// Records in the counters if the shape's arrays differ from the cached ones. Their counts must be the same.
void compare(const Geometry& geometry, cudaStream_t stream, const Shape& shape, const CachedMesh& known,
             Counters* counters);

}  // namespace crumple::cuda
