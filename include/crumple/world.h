#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "crumple/array.h"
#include "crumple/mesh.h"

namespace crumple {

/// Affine map: the three rows of (A | t), so that an array of shape (n, 3, 4) is n poses. Usually a rotation and a
/// translation, but A may be any matrix: it may scale, mirror or flatten. Each coordinate of a posed vertex is ((r0 x +
/// r1 y) + r2 z) + t in float64, without fused operations, rounded once to the precision of its shape; results are
/// exact for these rounded numbers.
struct Pose {
    std::array<double, 12> rows{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    friend bool operator==(const Pose&, const Pose&) = default;
};

/// View of poses in device memory, as written by a kernel: (n, 3, 4) numbers without gaps, in the layout of Pose, one
/// pose per body.
struct DevicePoses {
    const void* data = nullptr;  ///< aligned to its number type; null: no poses
    std::int64_t count = 0;
    ScalarType type = ScalarType::float64;  ///< float32 numbers are converted without loss
    void* stream = nullptr;                 ///< CUDA stream on which the poses become ready

    /// Makes a view of no poses.
    DevicePoses() = default;
    /// Views an array of Pose in device memory.
    DevicePoses(const Pose* poses, std::int64_t count, void* stream = nullptr)
        : data(poses), count(count), stream(stream) {}
    /// Views `count` poses of 12 `numbers` each, in device memory.
    /// @{
    DevicePoses(const double* numbers, std::int64_t count, void* stream = nullptr)
        : data(numbers), count(count), stream(stream) {}
    DevicePoses(const float* numbers, std::int64_t count, void* stream = nullptr)
        : data(numbers), count(count), type(ScalarType::float32), stream(stream) {}
    /// @}
};

/// View of the triangles, edges and points that bodies are made of; nothing is copied.
struct Shape {
    VertexView vertices;                   ///< (n, 3) coordinates
    TriangleView triangles;                ///< (m, 3) indices into `vertices`
    std::span<const std::int32_t> groups;  ///< one id per triangle, or empty: the body's group

    /// Nonzero: the caller promises that a shape with this name has the same contents in all later calls of the
    /// detector. The contents are validated and read in the first call only, and derived data is cached for all bodies
    /// of this shape; if the memory limit evicts it, the shape is read again. A different size or precision under the
    /// same name is an error.
    std::uint64_t name = 0;

    /// Positions of the vertices at the end of a step, for queries about motion: (n, 3). Without data the shape does
    /// not move. Intersections and nearness use the start.
    VertexView end = {};

    /// As MeshView::edges and MeshView::points. A feature that belongs to no triangle is in the body's group if the
    /// shape has no groups; if the shape has groups, the feature is in no group, and filters of groups do not drop its
    /// pairs.
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};

    /// For proximities: one per vertex, as ProximityQuery::radii. In the units of the world; poses do not scale them.
    /// If any shape has radii, all radii of a shape without them are 0.
    std::span<const double> radii = {};
    /// For proximities: the rest shape, as ProximityQuery::rest. Not posed; used for pairs within a body only.
    VertexView rest = {};

    /// Makes an empty shape without a name.
    Shape() = default;
    /// Views arrays of any layout, in host memory.
    Shape(VertexView vertices, TriangleView triangles, std::span<const std::int32_t> groups = {},
          std::uint64_t name = 0)
        : vertices(vertices), triangles(triangles), groups(groups), name(name) {}
    /// Views a mesh in host memory, with its end positions, edges and points.
    explicit Shape(const MeshView& mesh, std::uint64_t name = 0)
        : vertices(mesh.vertices),
          triangles(mesh.triangles),
          groups(mesh.groups),
          name(name),
          end(mesh.end),
          edges(mesh.edges),
          points(mesh.points) {}
};

/// Instance of a shape, in one world or in all.
struct Body {
    std::int32_t shape = 0;  ///< index into World::shapes
    std::int32_t group = 0;  ///< group of its triangles if the shape has no groups
    /// World id, 0 or more, or -1: in all worlds. Bodies of different worlds are never paired. Results have an entry
    /// for each id up to the largest.
    std::int32_t world = 0;
    bool self = false;  ///< true: includes pairs within the body, as for deformable bodies
};

/// Bodies and their poses, in one or many worlds. World ids ascend over the bodies; bodies that are in all worlds (-1)
/// come last.
struct World {
    std::span<const Shape> shapes;
    std::span<const Body> bodies;
    std::span<const Pose> poses;  ///< one per body; empty: identity for all
    /// Poses at the end of a step, for queries about motion: each posed vertex moves straight from start to end. Empty:
    /// the same as `poses`.
    std::span<const Pose> end_poses = {};
    /// Replaces `poses`: one per body, with the cuda backend only. Intersections are found on the device; for
    /// containment and all other queries the call copies the poses to the host.
    DevicePoses device_poses = {};
    DevicePoses device_end_poses = {};  ///< replaces `end_poses` if device_poses are given
};

}  // namespace crumple
