// Which format a mesh is written in, by extension, and what is checked before a byte is written.

#include <algorithm>
#include <cctype>
#include <cmath>

#include "io/atomic_file.h"
#include "io/formats.h"
#include "pipeline/float_environment.h"

namespace crumple::io {

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

void validate(const TriangleMesh& mesh) {
    const std::size_t scalars = std::visit([](const auto& xyz) { return xyz.size(); }, mesh.vertices);
    if (scalars % 3 != 0 || mesh.triangles.size() % 3 != 0) {
        throw Error(ErrorCode::invalid_argument, "vertices and triangles must have three numbers each");
    }
    if (scalars / 3 > INT32_MAX || mesh.triangle_count() > INT32_MAX) {
        throw Error(ErrorCode::invalid_argument, "more vertices or triangles than 32-bit ids can name");
    }
    if (!mesh.groups.empty() && static_cast<std::int64_t>(mesh.groups.size()) != mesh.triangle_count()) {
        throw Error(ErrorCode::invalid_argument, "the mesh has " + std::to_string(mesh.groups.size()) + " groups for " +
                                                     std::to_string(mesh.triangle_count()) + " triangles");
    }
    std::visit(
        [](const auto& xyz) {
            for (std::size_t i = 0; i < xyz.size(); ++i) {
                if (std::isfinite(xyz[i])) continue;
                const std::size_t vertex = i / 3;
                throw Error(ErrorCode::not_finite, "vertex " + std::to_string(vertex) + " is not finite",
                            Element::vertex, static_cast<std::int64_t>(vertex));
            }
        },
        mesh.vertices);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::int32_t corner = mesh.triangles[i];
        if (corner >= 0 && corner < mesh.vertex_count()) continue;
        const std::size_t triangle = i / 3;
        throw Error(ErrorCode::index_out_of_range,
                    "triangle " + std::to_string(triangle) + " names vertex " + std::to_string(corner) + " of " +
                        std::to_string(mesh.vertex_count()),
                    Element::triangle, static_cast<std::int64_t>(triangle));
    }
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
    const FloatEnvironment environment;
    const std::string extension = extension_of(path);
    void (*write)(std::ostream&, const TriangleMesh&) = nullptr;
    if (extension == ".ply") write = write_ply;
    if (extension == ".obj") write = write_obj;
    if (extension == ".stl") write = write_stl;
    if (extension == ".off") write = write_off;
    if (!write) {
        throw Error(ErrorCode::invalid_argument,
                    "cannot write " + path.string() + ": meshes are written as .ply, .obj, .stl or .off");
    }
    validate(mesh);
    AtomicFile file(path);
    write(file.stream(), mesh);
    file.commit();
}

}  // namespace crumple::io
