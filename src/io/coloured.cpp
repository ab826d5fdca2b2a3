// Meshes with colliding triangles coloured: one soup of the one or two meshes, and the format by extension.

#include <algorithm>

#include "io/atomic_file.h"
#include "io/formats.h"
#include "pipeline/float_environment.h"

namespace crumple::io {

namespace {

ColouredMesh join(const TriangleMesh& mesh, const TriangleMesh* second, const Collisions& collisions) {
    ColouredMesh result{mesh, {collisions.hit.begin(), collisions.hit.end()}};
    if (!second) return result;
    result.hit.insert(result.hit.end(), collisions.hit_second.begin(), collisions.hit_second.end());
    if (mesh.precision() != second->precision()) {
        result.mesh.vertices =
            std::visit([](const auto& xyz) { return std::vector<double>(xyz.begin(), xyz.end()); }, mesh.vertices);
    }
    std::visit(
        [&](auto& xyz) {
            std::visit([&](const auto& more) { xyz.insert(xyz.end(), more.begin(), more.end()); }, second->vertices);
        },
        result.mesh.vertices);
    if (result.mesh.vertex_count() > INT32_MAX) {
        throw Error(ErrorCode::invalid_argument, "more vertices than 32-bit ids can name");
    }
    const auto shift = static_cast<std::int32_t>(mesh.vertex_count());
    for (const std::int32_t corner : second->triangles) result.mesh.triangles.push_back(corner + shift);
    // Groups are kept if both have them: a made-up group could be taken for a real one.
    if (second->groups.empty()) result.mesh.groups.clear();
    if (!result.mesh.groups.empty()) {
        result.mesh.groups.insert(result.mesh.groups.end(), second->groups.begin(), second->groups.end());
    }
    return result;
}

void check_hits(const TriangleMesh& mesh, const Array<std::uint8_t>& hit) {
    if (static_cast<std::int64_t>(hit.size()) != mesh.triangle_count()) {
        throw Error(ErrorCode::invalid_argument, "the collisions are of " + std::to_string(hit.size()) +
                                                     " triangles, the mesh has " +
                                                     std::to_string(mesh.triangle_count()));
    }
}

}  // namespace

ColouredMesh coloured_mesh(const TriangleMesh& mesh, const TriangleMesh* second, const Collisions& collisions) {
    validate(mesh);
    check_hits(mesh, collisions.hit);
    if (second) {
        validate(*second);
        check_hits(*second, collisions.hit_second);
    }
    return join(mesh, second, collisions);
}

void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                    const Collisions& collisions) {
    const FloatEnvironment environment;
    const std::string extension = extension_of(path);
    if (extension != ".ply" && extension != ".obj" && extension != ".glb") {
        throw Error(ErrorCode::invalid_argument,
                    "cannot write " + path.string() + ": coloured meshes are written as .ply, .obj or .glb");
    }
    const ColouredMesh coloured = coloured_mesh(mesh, second, collisions);

    AtomicFile file(path);
    if (extension == ".ply") write_coloured_ply(file.stream(), coloured);
    if (extension == ".glb") write_coloured_glb(file.stream(), coloured);
    if (extension == ".obj") {
        const std::filesystem::path materials = std::filesystem::path(path).replace_extension(".mtl");
        write_coloured_obj(file.stream(), coloured, materials.filename().string());
        AtomicFile material_file(materials);
        write_materials(material_file.stream());
        material_file.commit();
    }
    file.commit();
}

}  // namespace crumple::io
