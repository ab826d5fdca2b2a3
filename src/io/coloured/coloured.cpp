// Writes meshes with colliding triangles coloured: joins two meshes into one, and chooses the format by extension.

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/gzip.h"
#include "io/formats.h"
#include "io/meshes/polygons.h"
#include "io/meshes/unit.h"

namespace crumple::io {

namespace {

/// Appends `more`, vertex or polygon ids of the second mesh. Adds `shift` to each, the number of such ids of the first
/// mesh.
void append(std::vector<std::int32_t>& to, const std::vector<std::int32_t>& more, std::int64_t shift) {
    for (const std::int32_t value : more) to.push_back(static_cast<std::int32_t>(value + shift));
}

/// Returns the polygons of a mesh, or each triangle as a polygon if it has none.
Polygons polygons_of(const TriangleMesh& mesh) {
    if (!mesh.polygons.empty()) return mesh.polygons;
    Polygons polygons{{}, {0}, mesh.triangles};
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
        polygons.of_triangle.push_back(t);
        polygons.offsets.push_back(3 * (std::int64_t{t} + 1));
    }
    return polygons;
}

bool has_hits_of_polygons(const TriangleMesh& mesh, const Array<std::uint8_t>& hit) {
    return static_cast<std::int64_t>(hit.size()) != mesh.triangle_count();
}

ColouredMesh join(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions) {
    ColouredMesh result{mesh, hit_triangles(mesh, collisions.hit)};
    if (second && mesh.unit == Unit::unknown) result.mesh.unit = second->unit;
    const bool of_polygons =
        has_hits_of_polygons(mesh, collisions.hit) || (second && has_hits_of_polygons(*second, collisions.hit_second));
    result.mesh.polygons = of_polygons ? polygons_of(mesh) : Polygons();
    if (!second) return result;
    const std::vector<std::uint8_t> more_hits = hit_triangles(*second, collisions.hit_second);
    result.hit.insert(result.hit.end(), more_hits.begin(), more_hits.end());
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
        throw Error(ErrorCode::invalid_argument, "the meshes have more vertices than 32-bit ids can number");
    }
    append(result.mesh.triangles, second->triangles, mesh.vertex_count());
    if (of_polygons) {
        const Polygons more = polygons_of(*second);
        Polygons& polygons = result.mesh.polygons;
        append(polygons.of_triangle, more.of_triangle, polygons.count());
        const std::int64_t corners = polygons.offsets.back();
        for (std::size_t i = 1; i < more.offsets.size(); ++i) polygons.offsets.push_back(corners + more.offsets[i]);
        append(polygons.corners, more.corners, mesh.vertex_count());
    }
    // Groups are kept only if both meshes have them: an invented group could be mistaken for a real one.
    if (second->groups.empty()) result.mesh.groups.clear();
    if (!result.mesh.groups.empty()) {
        result.mesh.groups.insert(result.mesh.groups.end(), second->groups.begin(), second->groups.end());
    }
    return result;
}

void check_hits(const TriangleMesh& mesh, const Array<std::uint8_t>& hit) {
    const auto hits = static_cast<std::int64_t>(hit.size());
    if (hits != mesh.triangle_count() && hits != polygon_count(mesh)) {
        throw Error(ErrorCode::invalid_argument, "the collisions are for " + std::to_string(hit.size()) +
                                                     " triangles, but the mesh has " +
                                                     std::to_string(mesh.triangle_count()));
    }
}

/// Throws Error (file) if a material file (.mtl) exists at this path and was not written by Crumple: an input of the
/// user may need it.
void check_materials(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::string first_line;
    if (!in || (std::getline(in, first_line) && first_line == title_of_materials)) return;
    throw Error(ErrorCode::file,
                "cannot write " + path.string() +
                    ": Crumple has not written this file, and does not replace it; choose another name",
                Element::none, -1, 0, EEXIST);
}

void write(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions,
           MeshFormat format) {
    if (format == MeshFormat::html) {
        check_collisions(mesh, second, collisions);
        return write_html(out, mesh, second, collisions);
    }
    const ColouredMesh coloured = coloured_mesh(mesh, second, collisions);
    if (format == MeshFormat::ply) return write_coloured_ply(out, coloured);
    format == MeshFormat::glb ? write_coloured_glb(out, coloured) : write_coloured_3mf(out, coloured);
}

}  // namespace

void check_collisions(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions) {
    validate(mesh);
    check_hits(mesh, collisions.hit);
    if (!second) return;
    validate(*second);
    check_hits(*second, collisions.hit_second);
    check_same_unit(mesh.unit, second->unit);
}

ColouredMesh coloured_mesh(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions) {
    check_collisions(mesh, second, collisions);
    return join(mesh, second, collisions);
}

bool has_colours(MeshFormat format) {
    return format == MeshFormat::ply || format == MeshFormat::obj || format == MeshFormat::glb ||
           format == MeshFormat::html || format == MeshFormat::threemf;
}

void check_has_colours(const std::filesystem::path& path, MeshFormat format) {
    if (has_colours(format)) return;
    throw Error(ErrorCode::invalid_argument,
                "cannot write " + path.string() + ": coloured meshes are written as .ply, .obj, .glb, .3mf or .html");
}

void check_has_colours(MeshFormat format) {
    if (has_colours(format) && format != MeshFormat::obj) return;
    throw Error(ErrorCode::invalid_argument,
                "coloured meshes are written to a stream as ply, glb, 3mf or html; obj needs a second file");
}

void write_coloured_obj(const std::filesystem::path& path, const ColouredMesh& coloured) {
    const std::filesystem::path materials = without_gzip_name(path).replace_extension(".mtl");
    check_materials(materials);
    AtomicFile file(path), material_file(materials);
    write_coloured_obj(file.stream(), coloured, materials.filename().string());
    write_materials(material_file.stream(), coloured.materials);
    file.complete();
    material_file.commit();
    file.commit();
}

void write_coloured(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                    const Intersections& collisions, MeshFormat format) {
    const FloatEnvironment environment;
    check_has_colours(format);
    write(out, mesh, second, collisions, format);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write a coloured mesh to the stream");
}

void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                    const Intersections& collisions) {
    const FloatEnvironment environment;
    const MeshFormat format = mesh_format_of(extension_of(path));
    check_has_colours(path, format);
    if (format == MeshFormat::obj) return write_coloured_obj(path, coloured_mesh(mesh, second, collisions));
    AtomicFile file(path);
    write(file.stream(), mesh, second, collisions, format);
    file.commit();
}

}  // namespace crumple::io
