#pragma once

// Mesh in device memory for feature queries, and its copy on the host.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "crumple/features.h"
#include "crumple/world.h"

namespace crumple {

/// Shape whose arrays all lie on the device, ready on `stream`.
struct DeviceShape {
    Shape shape;
    void* stream = nullptr;
};

/// Contents of a copy of a shape.
enum class Copied : std::uint8_t {
    topology,  ///< triangles, Shape::edges and Shape::points; all vertices at the origin
    all,
};

/// Copy of a shape, filled by a backend: its arrays, and `shape`, which views them.
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
