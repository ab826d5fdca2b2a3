#include "scene/outline.h"

#include <limits>

#include "crumple/error.h"

namespace crumple {
namespace {

constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();

}  // namespace

void check_mesh_outline(const MeshView& mesh, const std::string& subject, MemorySpace memory) {
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorCode::invalid_argument, subject + ' ' + what);
    };
    if (mesh.memory != memory)
        refuse(memory == MemorySpace::host ? "must be in host memory, not in device memory"
                                           : "must be in device memory, like the first mesh");
    if (mesh.vertices.rows < 0 || mesh.vertices.rows > most)
        refuse("has " + std::to_string(mesh.vertices.rows) + " vertices; 0 to 2147483647 are possible");
    if (mesh.triangles.rows < 0 || mesh.triangles.rows > most)
        refuse("has " + std::to_string(mesh.triangles.rows) + " triangles; 0 to 2147483647 are possible");
    if (const char* fault = fault_of(mesh.vertices)) refuse(std::string("has vertices that") + fault);
    if (const char* fault = fault_of(mesh.triangles)) refuse(std::string("has triangles that") + fault);
    if (!mesh.groups.empty() && static_cast<std::int64_t>(mesh.groups.size()) != mesh.triangles.rows)
        refuse("has " + std::to_string(mesh.groups.size()) + " group ids for " + std::to_string(mesh.triangles.rows) +
               " triangles");
}

PreparedScene outline_scene(const MeshView& a, const MeshView* b, MemorySpace memory) {
    PreparedScene scene;
    scene.between = b != nullptr;
    const std::array<const MeshView*, 2> meshes{&a, b};
    const std::array<std::string, 2> subject{b ? "the first mesh" : "the mesh", "the second mesh"};
    for (std::size_t side = 0; side < (b ? 2u : 1u); ++side) {
        const MeshView& mesh = *meshes[side];
        check_mesh_outline(mesh, subject[side], memory);
        scene.vertices[side] = mesh.vertices.rows;
        scene.triangles[side] = mesh.triangles.rows;
        scene.reader[side] = {static_cast<const std::byte*>(mesh.vertices.data), mesh.vertices.row_stride,
                              mesh.vertices.column_stride, mesh.vertices.type == ScalarType::float32};
        scene.float32 = scene.float32 && scene.reader[side].float32;
    }
    if (scene.vertex_count() > most || scene.triangle_count() > most)
        throw Error(ErrorCode::invalid_argument,
                    "both meshes together have more than 2147483647 vertices or triangles");
    return scene;
}

void outline_motion(const VertexView& end, PreparedScene& scene) {
    if (end.rows != scene.vertex_count())
        throw Error(ErrorCode::invalid_argument, "there are " + std::to_string(end.rows) + " vertices at the end for " +
                                                     std::to_string(scene.vertex_count()) + " at the start");
    if (end.rows > most_moving_vertices) throw Error(ErrorCode::invalid_argument, too_many_moving_vertices);
    if (const char* fault = fault_of(end))
        throw Error(ErrorCode::invalid_argument, std::string("the vertices at the end") + fault);
    scene.moving = true;
    scene.end = {static_cast<const std::byte*>(end.data), end.row_stride, end.column_stride,
                 end.type == ScalarType::float32};
    scene.float32 = scene.float32 && scene.end.float32;
}

std::string mesh_name(const PreparedScene& scene, std::size_t side) {
    if (!scene.between) return "";
    return side == 0 ? "first mesh: " : "second mesh: ";
}

void fail_not_finite(const std::string& which, std::int64_t vertex) {
    throw Error(ErrorCode::not_finite, which + "vertex " + std::to_string(vertex) + " is not finite", Element::vertex,
                vertex);
}

void fail_radius(const std::string& which, std::int64_t vertex) {
    throw Error(ErrorCode::invalid_argument,
                which + "the radius of vertex " + std::to_string(vertex) + " must be finite and 0 or more",
                Element::vertex, vertex);
}

void fail_index(const std::string& which, std::int64_t triangle, std::int64_t index, std::int64_t vertex_count) {
    throw Error(ErrorCode::index_out_of_range,
                which + "triangle " + std::to_string(triangle) + " names vertex " + std::to_string(index) + " of " +
                    std::to_string(vertex_count),
                Element::triangle, triangle);
}

}  // namespace crumple
