#pragma once

// Input of every backend: the validated triangles of one mesh, or of two meshes together.
//
// Vertices and triangles of the first mesh come first, those of the second follow. `corners` are indices in this joint
// numbering, three per triangle, with welded vertices replaced by the lowest equal one. Coordinates stay in the
// caller's memory. `corners` is the caller's own array if there is a single mesh, without welding, whose indices are
// aligned 32-bit integers without gaps; otherwise it is in SceneBuffers.

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

class BodyFilter;

/// Reads coordinates in the caller's memory.
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
    /// True if rows of three scalars follow each other without gaps.
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
    bool between = false;                    ///< true: two meshes, and only pairs with one triangle of each
    bool float32 = true;                     ///< true if all coordinates are float32 numbers
    std::array<VertexReader, 2> reader;      ///< readers of the first and of the second mesh
    std::array<std::int64_t, 2> vertices{};  ///< numbers of vertices of the first and of the second mesh
    std::array<std::int64_t, 2> triangles{};
    const std::int32_t* corners = nullptr;  ///< vertices of the triangles, 3 per triangle
    const std::int32_t* groups = nullptr;   ///< 1 per triangle, or null: all in group 0
    /// 1 per vertex: group of the edges and points at this vertex that no triangle has; null: all in group 0.
    const std::int32_t* lone_groups = nullptr;
    /// Pair filter of a scene made from a world, whose groups are indices of the filter's classes; null for other
    /// scenes.
    const BodyFilter* bodies = nullptr;
    /// First triangle of each of `worlds` worlds that are side by side in the scene, and the end; triangles of
    /// different worlds are never paired. Null: a single world.
    const std::int64_t* first_of_world = nullptr;
    int worlds = 1;
    bool moving = false;                       ///< true: a single mesh, whose vertices move straight to `end`
    VertexReader end;                          ///< positions at the end, if `moving`
    Vec3d low, high;                           ///< box of all vertices, at start and end; 0 if there are none
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
    /// Returns the position at the end; position() if nothing moves.
    Vec3d end_position(std::int64_t vertex) const { return moving ? end(vertex) : position(vertex); }
    CRUMPLE_HD Triangle triangle(std::int64_t t) const {
        const std::int32_t* c = corners + 3 * t;
        return {{position(c[0]), position(c[1]), position(c[2])}, {c[0], c[1], c[2]}};
    }
    CRUMPLE_HD std::int32_t group(std::int64_t t) const { return groups ? groups[t] : 0; }
    CRUMPLE_HD bool second(std::int64_t t) const { return t >= triangles[0]; }
};

/// Result of checking a chunk of vertices or triangles: for vertices their box, and true in `good` if all coordinates
/// are finite or all indices in range.
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

/// Maximum number of vertices of a moving scene, whose start and end positions are numbered together, as int32.
inline constexpr std::int64_t most_moving_vertices = std::int64_t{1} << 30;
inline constexpr const char* too_many_moving_vertices = "a moving scene can have at most 1073741824 vertices";

/// Adds end positions to a scene of one mesh and validates them. Throws Error: not_finite, invalid_argument.
void add_motion(const VertexView& end, ParallelFor& workers, SceneBuffers& buffers, PreparedScene& scene);

/// Returns the box of vertices [begin, end) of a view with its reader, and checks that they are finite.
ChunkCheck check_vertices(const VertexView& view, const VertexReader& reader, std::int64_t begin, std::int64_t end);

/// Throws Error (not_finite) that names the first vertex that is not finite, with the prefix `which`.
void check_finite(const VertexView& vertices, const std::string& which, ParallelFor& workers, SceneBuffers& buffers);

/// Sets names[v] to the lowest vertex that has the same position as v at the start and, if the scene moves, also at the
/// end. -0 equals +0. `table` is scratch.
void find_representatives(const PreparedScene& scene, Array<std::int32_t>& table, Array<std::int32_t>& names);

/// Validates one mesh (b null) or two on the threads of `workers`, and joins them. Throws Error: not_finite,
/// index_out_of_range, invalid_argument.
PreparedScene prepare_scene(const MeshView& a, const MeshView* b, bool weld, ParallelFor& workers,
                            SceneBuffers& buffers);

}  // namespace crumple
