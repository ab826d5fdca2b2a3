#pragma once

// What is known of a scene before its arrays are read: shapes, counts, places. And the words for what may be wrong with
// them, the same wherever the arrays are checked.

#include <cstdint>
#include <string>

#include "crumple/mesh.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Throws Error (invalid_argument) if counts, pointers or groups of the mesh make no sense, or it lies elsewhere than
/// in `memory`. `subject`: what the message calls it.
void check_mesh_outline(const MeshView& mesh, const std::string& subject, MemorySpace memory);

/// Counts and readers of one mesh (b null) or two that lie in `memory`. Throws Error (invalid_argument).
PreparedScene outline_scene(const MeshView& a, const MeshView* b, MemorySpace memory);

/// Gives each vertex of a scene of one mesh an end, which is not read. Throws Error (invalid_argument).
void outline_motion(const VertexView& end, PreparedScene& scene);

/// Of two meshes, which: what an element's place begins with. Of one, nothing.
std::string mesh_name(const PreparedScene& scene, std::size_t side);

/// Calls `function` with a value of the type that indices have.
template <class Function>
void with_index_type(IndexType type, Function function) {
    switch (type) {
        case IndexType::int32:
            function(std::int32_t{});
            break;
        case IndexType::uint32:
            function(std::uint32_t{});
            break;
        case IndexType::int64:
            function(std::int64_t{});
            break;
    }
}

[[noreturn]] void fail_not_finite(const std::string& which, std::int64_t vertex);
[[noreturn]] void fail_radius(const std::string& which, std::int64_t vertex);
[[noreturn]] void fail_index(const std::string& which, std::int64_t triangle, std::int64_t index,
                             std::int64_t vertex_count);

}  // namespace crumple
