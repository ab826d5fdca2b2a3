// Writes meshes and worlds: chooses the format by extension, and validates meshes and worlds before it writes a byte.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/gzip.h"
#include "io/formats.h"
#include "io/scenes/world_mesh.h"

namespace crumple::io {

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = without_gzip_name(path).extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

namespace {

/// Throws Error (invalid_argument) unless the polygons fit the mesh's triangles and vertices.
void validate_polygons(const TriangleMesh& mesh) {
    const auto& [of_triangle, offsets, corners] = mesh.polygons;
    if (of_triangle.empty()) return;
    bool sound = static_cast<std::int64_t>(of_triangle.size()) == mesh.triangle_count() && !offsets.empty() &&
                 offsets[0] == 0 && offsets.back() == static_cast<std::int64_t>(corners.size());
    std::size_t triangle = 0;
    for (std::size_t i = 0; sound && i + 1 < offsets.size(); ++i) {
        const std::int64_t triangles = offsets[i + 1] - offsets[i] - 2;
        sound = triangles >= 1 && triangles <= static_cast<std::int64_t>(of_triangle.size() - triangle);
        for (std::int64_t k = 0; sound && k < triangles; ++k)
            sound = of_triangle[triangle++] == static_cast<std::int32_t>(i);
    }
    sound = sound && triangle == of_triangle.size();
    for (const std::int32_t corner : corners) sound = sound && corner >= 0 && corner < mesh.vertex_count();
    if (!sound) throw Error(ErrorCode::invalid_argument, "the polygons are not those of the mesh's triangles");
}

}  // namespace

void validate(const TriangleMesh& mesh) {
    validate_polygons(mesh);
    const std::size_t scalars = std::visit([](const auto& xyz) { return xyz.size(); }, mesh.vertices);
    if (scalars % 3 != 0 || mesh.triangles.size() % 3 != 0) {
        throw Error(ErrorCode::invalid_argument, "vertices and triangles must have three numbers each");
    }
    if (scalars / 3 > INT32_MAX || mesh.triangle_count() > INT32_MAX) {
        throw Error(ErrorCode::invalid_argument, "the mesh has more vertices or triangles than 32-bit ids can number");
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

namespace {

using Writer = void (*)(std::ostream&, const TriangleMesh&, bool polygons);

Writer writer_of(MeshFormat format) {
    switch (format) {
        case MeshFormat::ply:
            return write_ply;
        case MeshFormat::obj:
            return write_obj;
        case MeshFormat::stl:
            return write_stl;
        case MeshFormat::off:
            return write_off;
        case MeshFormat::glb:
            return write_glb;
        case MeshFormat::threemf:
            return write_3mf;
        case MeshFormat::automatic:
        case MeshFormat::html:
            break;
    }
    return nullptr;
}

}  // namespace

bool holds_meshes(MeshFormat format) { return writer_of(format) != nullptr; }

MeshFormat mesh_format_of(std::string_view extension) {
    constexpr std::pair<std::string_view, MeshFormat> known[] = {
        {".ply", MeshFormat::ply},     {".obj", MeshFormat::obj}, {".stl", MeshFormat::stl},
        {".off", MeshFormat::off},     {".glb", MeshFormat::glb}, {".html", MeshFormat::html},
        {".3mf", MeshFormat::threemf},
    };
    for (const auto& [name, format] : known) {
        if (extension == name) return format;
    }
    return MeshFormat::automatic;
}

void write_mesh(std::ostream& out, const TriangleMesh& mesh, MeshFormat format, const WriteOptions& options) {
    const FloatEnvironment environment;
    const Writer write = writer_of(format);
    if (!write) throw Error(ErrorCode::invalid_argument, "meshes are written as ply, obj, stl, off, glb or 3mf");
    validate(mesh);
    write(out, mesh, options.polygons && !mesh.polygons.empty());
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write a mesh to the stream");
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, const WriteOptions& options) {
    const FloatEnvironment environment;
    const Writer write = writer_of(mesh_format_of(extension_of(path)));
    if (!write) {
        throw Error(ErrorCode::invalid_argument,
                    "cannot write " + path.string() + ": meshes are written as .ply, .obj, .stl, .off, .glb or .3mf");
    }
    validate(mesh);
    AtomicFile file(path);
    write(file.stream(), mesh, options.polygons && !mesh.polygons.empty());
    file.commit();
}

void write_world(std::ostream& out, const WorldMesh& world, MeshFormat format) {
    const FloatEnvironment environment;
    if (format != MeshFormat::threemf && format != MeshFormat::glb)
        throw Error(ErrorCode::invalid_argument, "worlds are written as glb or 3mf");
    validate(world);
    format == MeshFormat::glb ? write_glb(out, world) : write_3mf(out, world);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write a world to the stream");
}

void write_world(const std::filesystem::path& path, const WorldMesh& world) {
    const MeshFormat format = mesh_format_of(extension_of(path));
    if (format != MeshFormat::threemf && format != MeshFormat::glb)
        throw Error(ErrorCode::invalid_argument,
                    "cannot write " + path.string() + ": worlds are written as .glb or .3mf");
    validate(world);
    AtomicFile file(path);
    write_world(file.stream(), world, format);
    file.commit();
}

void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
    AtomicFile file(path);
    file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.commit();
}

}  // namespace crumple::io
