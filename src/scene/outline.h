#pragma once

// Outline of a scene: sizes, types, strides and pointers of its arrays, validated before their contents are read. Also
// the error messages about invalid contents, for all code that validates them.

#include <cstdint>
#include <string>

#include "crumple/mesh.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Returns the end of an error message if the rows of the view cannot be read, otherwise null.
template <class Type>
const char* fault_of(const ArrayView<Type>& view) {
    if (view.rows <= 0) return nullptr;
    if (!view.data) return " have no data";
    const bool has_strides = view.row_stride != view.no_stride && view.column_stride != view.no_stride;
    return has_strides ? nullptr : " have no strides; set row_stride and column_stride";
}

/// Throws Error (invalid_argument) if counts, pointers, strides or groups of the mesh are invalid, or if it is not in
/// `memory`. `subject`: the name of the mesh in the message.
void check_mesh_outline(const MeshView& mesh, const std::string& subject, MemorySpace memory);

/// Returns a scene with the counts and readers of one mesh (b null) or two, which must be in `memory`. Throws Error
/// (invalid_argument).
PreparedScene outline_scene(const MeshView& a, const MeshView* b, MemorySpace memory);

/// Adds end positions to a scene of one mesh, without reading them. Throws Error (invalid_argument).
void outline_motion(const VertexView& end, PreparedScene& scene);

/// Returns the prefix of errors about an element: "first mesh: " or "second mesh: " for two meshes, empty for one.
std::string mesh_name(const PreparedScene& scene, std::size_t side);

/// Calls `function` with a value of the C++ type of the indices.
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
