#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "crumple/array.h"
#include "crumple/mesh.h"

namespace crumple {

/// An affine map: the three rows of (A | t), so that an array of shape (n, 3, 4) is n poses. Rotation and translation
/// as a rule; scale, reflection and maps that flatten are as good. Each coordinate of a posed vertex is
/// ((r0 x + r1 y) + r2 z) + t in float64, without fused operations, rounded once to the precision of its shape; answers
/// are exact for these numbers.
struct Pose {
    std::array<double, 12> rows{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    friend bool operator==(const Pose&, const Pose&) = default;
};

/// Poses in the memory of a device, as a kernel has written them: the numbers of one Pose a body, row by row and
/// without gaps, (n, 3, 4). A view, nothing is copied.
struct DevicePoses {
    const void* data = nullptr;  ///< aligned to its numbers; null: there are none
    std::int64_t count = 0;
    ScalarType type = ScalarType::float64;  ///< float32 numbers count as the float64 numbers that they are
    void* stream = nullptr;                 ///< CUDA stream on which they become ready

    DevicePoses() = default;
    DevicePoses(const Pose* poses, std::int64_t count, void* stream = nullptr)
        : data(poses), count(count), stream(stream) {}
    DevicePoses(const double* numbers, std::int64_t count, void* stream = nullptr)
        : data(numbers), count(count), stream(stream) {}
    DevicePoses(const float* numbers, std::int64_t count, void* stream = nullptr)
        : data(numbers), count(count), type(ScalarType::float32), stream(stream) {}
};

/// Triangles, and edges and points, that bodies are made of; a view, nothing is copied.
struct Shape {
    VertexView vertices;                   ///< (n, 3) coordinates
    TriangleView triangles;                ///< (m, 3) indices into `vertices`
    std::span<const std::int32_t> groups;  ///< one id a triangle, or empty: that of the body

    /// Not 0: what this number names has the same contents now and in later calls of the detector. It is checked and
    /// read in the first call only, and what was computed is kept, for all bodies of this shape; where it must go under
    /// a memory limit, it is read again. Another size or precision under a known name is an error.
    std::uint64_t name = 0;

    /// Where the vertices are at the end of a step, for queries about motion: (n, 3); without data they stay.
    /// Intersections and nearness are those of the start.
    VertexView end = {};

    /// As MeshView::edges and MeshView::points. What no triangle names is of the body's group where the shape has no
    /// groups, and of none where it has: then a filter of groups says nothing of it.
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};

    /// For proximities: see ProximityQuery::radii. In the units of the world, whatever the pose. If any shape has some,
    /// those of shapes without are 0.
    std::span<const double> radii = {};
    /// For proximities: see ProximityQuery::rest. Before poses, and for pairs within a body only.
    VertexView rest = {};

    Shape() = default;
    Shape(VertexView vertices, TriangleView triangles, std::span<const std::int32_t> groups = {},
          std::uint64_t name = 0)
        : vertices(vertices), triangles(triangles), groups(groups), name(name) {}
    /// A mesh in host memory.
    explicit Shape(const MeshView& mesh, std::uint64_t name = 0)
        : vertices(mesh.vertices),
          triangles(mesh.triangles),
          groups(mesh.groups),
          name(name),
          end(mesh.end),
          edges(mesh.edges),
          points(mesh.points) {}
};

struct Body {
    std::int32_t shape = 0;  ///< index into World::shapes
    std::int32_t group = 0;  ///< of its triangles, where the shape has no groups of its own
    /// Bodies of different worlds never meet; -1: in all worlds. Answers have an entry for each id up to the largest.
    std::int32_t world = 0;
    bool self = false;  ///< whether pairs within the body are wanted, as of a deformable one
};

/// Bodies, and where they are. World ids ascend over the bodies, and those that are in all worlds (-1) come last.
struct World {
    std::span<const Shape> shapes;
    std::span<const Body> bodies;
    std::span<const Pose> poses;  ///< one a body; empty: all as given
    /// The same at the end of a step, for queries about motion: posed vertices go straight from the one place to the
    /// other. Empty: as `poses`.
    std::span<const Pose> end_poses = {};
    /// Instead of `poses`: one a body, with the cuda backend. Intersections are found on the device, whatever else is
    /// asked of copies that the call makes of the poses.
    DevicePoses device_poses = {};
    DevicePoses device_end_poses = {};  ///< instead of `end_poses`, where device_poses are given
};

}  // namespace crumple
