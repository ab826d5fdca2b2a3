#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "crumple/array.h"
#include "crumple/collisions.h"
#include "crumple/mesh.h"
#include "crumple/options.h"

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

    /// Where the vertices are at the end of a step, for Motion: (n, 3); without data they stay. Intersections and
    /// nearness are those of the start.
    VertexView end = {};

    /// As MeshView::edges and MeshView::points. What no triangle names is of the body's group where the shape has no
    /// groups, and of none where it has: then rules about groups say nothing of it.
    std::optional<std::span<const Edge>> edges = {};
    std::optional<std::span<const std::int32_t>> points = {};

    /// For Near: see Near::radii. In the units of the world, whatever the pose. If any shape has some, those of shapes
    /// without are 0.
    std::span<const double> radii = {};
    /// For Near: see Near::rest. Before poses, and for pairs within a body only.
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
    /// The same at the end of a step, for Motion: posed vertices go straight from the one place to the other. Empty: as
    /// `poses`.
    std::span<const Pose> end_poses = {};
    /// Instead of `poses`: one a body, with the cuda backend. Intersections are found on the device, whatever else is
    /// asked of copies that the call makes of the poses.
    DevicePoses device_poses = {};
    DevicePoses device_end_poses = {};  ///< instead of `end_poses`, where device_poses are given
};

/// Two bodies by their index; the order does not matter.
struct BodyPair {
    std::int32_t first, second;
    friend auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

/// Which pairs of triangles may collide.
struct Rules {
    Wanted bodies = Wanted::both;  ///< pairs within a body, between bodies, or both; Body::self holds as well
    Wanted groups = Wanted::both;  ///< the same for groups
    /// Not tested against each other, or (a body and itself) within: "allowed collision matrix" of robotics.
    std::vector<BodyPair> excluded_bodies;
    std::vector<GroupPair> excluded_groups;
};

/// How much of the answer is wanted; each ends as soon as it may.
enum class Wants : std::uint8_t {
    any,           ///< whether anything collides
    any_by_world,  ///< whether anything collides in each world
    body_pairs,    ///< which bodies collide
    count,         ///< how many pairs of triangles, in all and in each world
    pairs,         ///< all pairs of triangles
    contacts,      ///< and where each pair meets
};

/// What intersects what (docs/contract.md). A value: it owns what it names.
struct Intersect {
    Wants wants = Wants::pairs;
    Neighbours neighbours = Neighbours::geometric;
    Intersections intersections = Intersections::all;
    bool weld = false;  ///< vertices at equal posed positions count as one, also those of different bodies
    Rules rules = {};
    bool index = false;  ///< also make offsets and hit flags, where pairs are wanted
};

/// The answer for a world. Pairs are unique and in the order of: first body, its triangle, second body, its triangle.
/// So worlds follow each other, and pairs among bodies that are in all worlds, which come once, are last.
struct WorldCollisions {
    bool any = false;        ///< whether anything collides
    std::int64_t count = 0;  ///< pairs of triangles, where they are counted or listed; else 0

    Array<std::uint8_t> world_hit;     ///< one a world: something collides (not for Wants::any)
    Array<std::int64_t> world_counts;  ///< one a world: pairs of triangles (from Wants::count on)

    Array<BodyPair> bodies;  ///< for each pair its bodies; for Wants::body_pairs the colliding ones, each once
    Array<Pair> pairs;       ///< triangles, as they count within their bodies; a < b within one body
    Contacts contacts;

    // Where Intersect::index asks for them:
    Array<std::int64_t>
        world_offsets;                 ///< pairs of world w: [world_offsets[w], world_offsets[w + 1]); the rest follows
    Array<std::int64_t> body_offsets;  ///< pairs whose first body is b: [body_offsets[b], body_offsets[b + 1])
    Array<std::int64_t> first_triangle;  ///< of each body, in `hit`; the number of bodies + 1
    Array<std::uint8_t> hit;             ///< 1 for each triangle of each body that is in some pair

    Statistics statistics;
};

/// An answer for a world that lies in the memory of a device: pointers of the device, in the order of WorldCollisions.
/// How long it is valid, Detector::wait_worlds says.
struct DeviceWorldCollisions {
    /// False if lists of fixed length were too short for it (Detector::launch in a capture): there are no arrays.
    bool complete = true;
    /// Pairs that there are; where the answer is not complete, those that were found, and there may be more.
    std::int64_t pairs_needed = 0;
    bool any = false;        ///< whether anything collides
    std::int64_t count = 0;  ///< pairs of triangles

    std::int64_t worlds = 0;
    const std::uint8_t* world_hit = nullptr;      ///< worlds: something collides
    const std::int64_t* world_counts = nullptr;   ///< worlds: pairs of triangles
    const std::int64_t* world_offsets = nullptr;  ///< worlds + 1: pairs of world w begin here; the rest follows

    const BodyPair* bodies = nullptr;  ///< count: for each pair its bodies; null below Wants::pairs, as `pairs`
    const Pair* pairs = nullptr;       ///< count: triangles, as they count within their bodies
    const ContactKind* contact_kinds = nullptr;             ///< count; null unless asked for
    const std::int64_t* contact_offsets = nullptr;          ///< count + 1
    const std::array<double, 3>* contact_points = nullptr;  ///< contact_point_count
    std::int64_t contact_point_count = 0;
    Statistics statistics;
};

}  // namespace crumple
