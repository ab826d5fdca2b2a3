#pragma once

// A mesh in device memory that is asked about its features, and a copy of one on the host.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crumple/features.h"
#include "crumple/world.h"

namespace crumple {

/// All arrays of the shape lie on the device, where they are ready on the stream.
struct DeviceShape {
    Shape shape;
    void* stream = nullptr;
};

/// What a copy of a shape has.
enum class Copied : std::uint8_t {
    topology,  ///< triangles, and edges and points that are listed; vertices are all at the origin
    all,
};

/// A copy, and the shape that views it. Filled by a backend.
struct HostShape {
    HostShape() = default;
    HostShape(const HostShape&) = delete;

    std::vector<std::byte> vertices, triangles, end, rest;
    std::vector<std::int32_t> groups, points;
    std::vector<Edge> edges;
    std::vector<double> radii;
    Shape shape;
};

}  // namespace crumple
