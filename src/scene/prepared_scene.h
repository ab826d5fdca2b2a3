#pragma once

// What every backend is given: one or two meshes as one soup, checked.
//
// Vertices and triangles of the first mesh come first, those of the second follow; `corners` are indices into that
// joint numbering, three a triangle, with welded vertices replaced by the lowest of their kind. Coordinates stay where
// the caller has them. `corners` is the caller's own array where that is one contiguous int32 mesh and nothing is
// welded; otherwise it lies in SceneBuffers.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"

namespace crumple {

class BodyRules;

/// Reads coordinates where the caller left them.
struct VertexReader {
    const std::byte* data = nullptr;
    std::int64_t row_stride = 0, column_stride = 0;
    bool float32 = true;

    friend bool operator==(const VertexReader&, const VertexReader&) = default;
    CRUMPLE_HD Vec3d operator()(std::int64_t i) const {
        const std::byte* row = data + i * row_stride;
        return float32 ? read<float>(row) : read<double>(row);
    }
    std::size_t scalar_bytes() const { return float32 ? sizeof(float) : sizeof(double); }
    /// Rows of three scalars, one behind the other.
    bool contiguous() const {
        const auto size = static_cast<std::int64_t>(scalar_bytes());
        return column_stride == size && row_stride == 3 * size;
    }
    template <class T>
    CRUMPLE_HD Vec3d read(const std::byte* row) const {
        T x, y, z;
        std::memcpy(&x, row, sizeof(T));
        std::memcpy(&y, row + column_stride, sizeof(T));
        std::memcpy(&z, row + 2 * column_stride, sizeof(T));
        return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    }
};

struct PreparedScene {
    bool between = false;                    ///< two meshes: pairs across only
    bool float32 = true;                     ///< all coordinates are float32 numbers
    std::array<VertexReader, 2> reader;      ///< of the first and the second mesh
    std::array<std::int64_t, 2> vertices{};  ///< counts
    std::array<std::int64_t, 2> triangles{};
    const std::int32_t* corners = nullptr;      ///< 3 a triangle
    const std::int32_t* groups = nullptr;       ///< 1 a triangle, or null: all in group 0
    const std::int32_t* lone_groups = nullptr;  ///< 1 a vertex: of features of no triangle; or null: in group 0
    const BodyRules* bodies = nullptr;          ///< of a world: its groups are classes of these, which decide
    /// Worlds side by side, which never meet: the first triangle of each, and how many there are in all; null: one
    /// world has all.
    const std::int64_t* first_of_world = nullptr;
    int worlds = 1;
    bool moving = false;  ///< one mesh, whose vertices go straight to `end`
    VertexReader end;
    Vec3d low, high;                           ///< box of all vertices, also at their ends; 0 if there are none
    std::array<Vec3d, 2> side_low, side_high;  ///< box of each mesh's vertices; low > high if there are none

    friend bool operator==(const PreparedScene&, const PreparedScene&) = default;
    CRUMPLE_HD std::int64_t vertex_count() const { return vertices[0] + vertices[1]; }
    CRUMPLE_HD std::int64_t triangle_count() const { return triangles[0] + triangles[1]; }
    std::int64_t largest_world() const {
        std::int64_t largest = first_of_world ? 0 : triangle_count();
        for (int w = 0; first_of_world && w < worlds; ++w)
            largest = std::max(largest, first_of_world[w + 1] - first_of_world[w]);
        return largest;
    }
    CRUMPLE_HD Vec3d position(std::int64_t vertex) const {
        return vertex < vertices[0] ? reader[0](vertex) : reader[1](vertex - vertices[0]);
    }
    /// The same as position() where nothing moves.
    Vec3d end_position(std::int64_t vertex) const { return moving ? end(vertex) : position(vertex); }
    CRUMPLE_HD Triangle triangle(std::int64_t t) const {
        const std::int32_t* c = corners + 3 * t;
        return {{position(c[0]), position(c[1]), position(c[2])}, {c[0], c[1], c[2]}};
    }
    CRUMPLE_HD std::int32_t group(std::int64_t t) const { return groups ? groups[t] : 0; }
    CRUMPLE_HD bool second(std::int64_t t) const { return t >= triangles[0]; }
};

/// What the check of a chunk of vertices or of triangles found.
struct ChunkCheck {
    Vec3d low, high;
    bool good;
};

struct SceneBuffers {
    Array<std::int32_t> corners, groups, representative, table;
    Array<ChunkCheck> checks;
    explicit SceneBuffers(MemoryMeter* meter = nullptr)
        : corners(meter), groups(meter), representative(meter), table(meter), checks(meter) {}
};

/// Both ends of a way are numbered by int32.
inline constexpr std::int64_t most_moving_vertices = std::int64_t{1} << 30;
inline constexpr const char* too_many_moving_vertices = "in motion there may be 1073741824 vertices at most";

/// Gives each vertex of a scene of one mesh an end. Throws Error: not_finite, invalid_argument.
void add_motion(const VertexView& end, ParallelFor& workers, SceneBuffers& buffers, PreparedScene& scene);

/// Throws Error (not_finite) that names the first vertex that is not finite, after `which`.
void check_finite(const VertexView& vertices, const std::string& which, ParallelFor& workers, SceneBuffers& buffers);

/// names[v]: the lowest vertex at v's position, at the start and, if the scene moves, at the end. -0 equals +0.
/// `table` is scratch.
void name_equal_positions(const PreparedScene& scene, Array<std::int32_t>& table, Array<std::int32_t>& names);

/// Checks one mesh (b null) or two, on the threads of `workers`, and joins them. Throws Error: not_finite,
/// index_out_of_range, invalid_argument.
PreparedScene prepare_scene(const MeshView& a, const MeshView* b, bool weld, ParallelFor& workers,
                            SceneBuffers& buffers);

}  // namespace crumple
