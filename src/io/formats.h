#pragma once

// Readers and writers of mesh files, one of each per format, and what they have in common.

#include <array>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "crumple/io.h"
#include "io/bytes/source.h"

namespace crumple::io {

TriangleMesh read_ply(const Source& source, const ReadOptions& options, Warnings& warnings);
TriangleMesh read_obj(const Source& source, const ReadOptions& options, Warnings& warnings);
/// Reads an STL file. Returns three vertices per triangle, not welded.
TriangleMesh read_stl(const Source& source, const ReadOptions& options, Warnings& warnings);
TriangleMesh read_off(const Source& source, const ReadOptions& options, Warnings& warnings);

/// True if the file has exactly 84 bytes plus 50 for each triangle that it announces. A text file would need 7 GB to
/// match.
bool is_binary_stl(const Source& source);
/// Returns the length of the keyword of an OFF file at the start of a word: prefixes (ST, C, N, 4, n) that announce the
/// data of a vertex, in any order, then "OFF". Digits (a count) may follow. Returns 0 if there is no keyword.
std::size_t off_keyword(std::string_view word);
/// True if the word is a statement that OBJ files usually begin with.
bool starts_obj(std::string_view word);

struct Colour {
    std::uint8_t red, green, blue;
};
inline constexpr Colour free_colour{178, 178, 178};
inline constexpr Colour colliding_colour{213, 94, 0};  // vermilion: strong on grey, also to the colour-blind

/// Colour and the name that files give it.
struct Material {
    const char* name;
    Colour colour;
    double opacity = 1;  ///< below 1: translucent
};
inline constexpr std::array<Material, 2> collision_materials{{{"free", free_colour}, {"colliding", colliding_colour}}};
inline constexpr std::array<Material, 2> overlap_materials{
    {{"outside", free_colour, 0.2}, {"inside", colliding_colour}}};

/// Input of the writers of coloured meshes: one mesh, or two that are joined, with polygons if these are coloured
/// instead of triangles.
struct ColouredMesh {
    TriangleMesh mesh;
    std::vector<std::uint8_t> hit;  ///< per triangle: index of its material, or of a shade; for collisions 0 or 1
    std::span<const Material> materials = collision_materials;  ///< the materials that `hit` indexes

    bool has_polygons() const { return !mesh.polygons.empty(); }
};

/// Calls f(corners, first triangle) for each triangle of the mesh, or for each polygon.
template <class F>
void for_each_face(const TriangleMesh& mesh, bool polygons, F f) {
    if (!polygons) {
        for (std::size_t t = 0; t < mesh.triangles.size() / 3; ++t)
            f(std::span<const std::int32_t>(&mesh.triangles[3 * t], 3), t);
        return;
    }
    std::size_t triangle = 0;
    for (std::size_t i = 0; i + 1 < mesh.polygons.offsets.size(); ++i) {
        const auto begin = static_cast<std::size_t>(mesh.polygons.offsets[i]);
        const std::size_t corners = static_cast<std::size_t>(mesh.polygons.offsets[i + 1]) - begin;
        f(std::span<const std::int32_t>(&mesh.polygons.corners[begin], corners), triangle);
        triangle += corners - 2;
    }
}

/// Throws Error unless both meshes are valid and the collisions are those of these meshes. `second` may be null.
void check_collisions(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions);

/// Joins both meshes into one, after the checks of check_collisions().
ColouredMesh coloured_mesh(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions);

/// Write a mesh. `polygons`: faces are the mesh's polygons, where the format has polygons.
void write_ply(std::ostream& out, const TriangleMesh& mesh, bool polygons);
void write_obj(std::ostream& out, const TriangleMesh& mesh, bool polygons);
void write_stl(std::ostream& out, const TriangleMesh& mesh, bool);
void write_off(std::ostream& out, const TriangleMesh& mesh, bool polygons);
void write_3mf(std::ostream& out, const TriangleMesh& mesh, bool);
void write_glb(std::ostream& out, const TriangleMesh& mesh, bool);
/// Write a world without colours.
void write_3mf(std::ostream& out, const WorldMesh& world);
void write_glb(std::ostream& out, const WorldMesh& world);

void write_coloured_ply(std::ostream& out, const ColouredMesh& coloured);
void write_coloured_obj(std::ostream& out, const ColouredMesh& coloured, const std::string& material_file);
/// Writes the material file that write_coloured_obj() refers to. It begins with the line `title_of_materials`.
void write_materials(std::ostream& out, std::span<const Material> materials);
inline constexpr std::string_view title_of_materials = "# Crumple: materials of free and of colliding triangles";
/// Writes the .obj file and the .mtl file beside it; both are complete before either is put in place. Throws as the
/// public write_coloured does.
void write_coloured_obj(const std::filesystem::path& path, const ColouredMesh& coloured);
void write_coloured_glb(std::ostream& out, const ColouredMesh& coloured);
void write_coloured_3mf(std::ostream& out, const ColouredMesh& coloured);
/// Writes a world. `hit`: index of the material of each triangle of each body. Both `hit` and `materials` are empty for
/// a world without colours.
void write_coloured_3mf(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit,
                        std::span<const Material> materials);
/// Writes a mesh whose `hit` holds indices of `shades`.
void write_shaded_glb(std::ostream& out, const ColouredMesh& coloured, std::span<const Colour> shades);
/// Writes a world, with a node for each body. `hit`: index of the material of each triangle of each body.
void write_coloured_glb(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit,
                        std::span<const Material> materials);
/// Writes a whole page if `height` is 0, else a fragment of a page that is `height` pixels high. The collisions must be
/// those of the meshes.
void write_html(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                const Intersections& collisions, int height = 0);
/// Writes a page that shows opaque triangles through translucent ones, and lines. `lines`: two end points per line.
void write_overlap_html(std::ostream& out, const ColouredMesh& coloured, std::vector<std::array<double, 3>> lines,
                        const std::string& caption);

/// Returns the lower-case extension, with its dot; ".obj" for mesh.obj.gz.
std::string extension_of(const std::filesystem::path& path);
/// Return the format of an extension (lower case, with its dot); `automatic` if it is that of no format.
MeshFormat mesh_format_of(std::string_view extension);
PairFormat pair_format_of(std::string_view extension);
/// True if meshes (holds_meshes) or coloured meshes (has_colours) can be written in this format.
bool holds_meshes(MeshFormat format);
bool has_colours(MeshFormat format);
/// Throw Error (invalid_argument) unless coloured meshes can be written in this format, to a path or to a stream.
void check_has_colours(const std::filesystem::path& path, MeshFormat format);
void check_has_colours(MeshFormat format);

/// Throws Error unless the arrays have the right sizes, indices are in range and coordinates finite.
void validate(const TriangleMesh& mesh);

/// Calls f with a zero of the scalar type that the mesh is to have: float or double, the type of the file unless
/// another is requested. f must return a mesh with this scalar type.
template <class F>
TriangleMesh in_precision(Precision asked, ScalarType of_file, F&& f) {
    const bool single = asked == Precision::automatic ? of_file == ScalarType::float32 : asked == Precision::float32;
    return single ? f(float{}) : f(double{});
}

}  // namespace crumple::io
