#pragma once

// One reader and one writer a format; what they have in common.

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
/// Three vertices a triangle, not welded.
TriangleMesh read_stl(const Source& source, const ReadOptions& options, Warnings& warnings);
TriangleMesh read_off(const Source& source, const ReadOptions& options, Warnings& warnings);

/// 84 bytes and 50 for each of the triangles that it announces: a file of text would need 7 GB for that.
bool is_binary_stl(const Source& source);
/// Length of the keyword that a word begins with: "OFF" after prefixes that tell what a vertex has (ST, C, N, 4, n), in
/// any order. Digits may follow, a count. 0 if the word is none.
std::size_t off_keyword(std::string_view word);
/// A statement that OBJ files begin with.
bool starts_obj(std::string_view word);

struct Colour {
    std::uint8_t red, green, blue;
};
inline constexpr Colour free_colour{178, 178, 178};
inline constexpr Colour colliding_colour{213, 94, 0};  // vermilion: strong on grey, also to the colour-blind

/// Colour under the name that files give it.
struct Material {
    const char* name;
    Colour colour;
    double opacity = 1;  ///< below 1: translucent
};
inline constexpr std::array<Material, 2> collision_materials{{{"free", free_colour}, {"colliding", colliding_colour}}};
inline constexpr std::array<Material, 2> overlap_materials{
    {{"outside", free_colour, 0.2}, {"inside", colliding_colour}}};

/// What the writers colour: one soup of one or two meshes, with polygons if these are coloured instead of triangles.
struct ColouredMesh {
    TriangleMesh mesh;
    std::vector<std::uint8_t> hit;  ///< which triangles collide, or whose polygons do: 1, or a shade
    std::span<const Material> materials = collision_materials;  ///< by `hit`

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

/// Throws unless both meshes are sound and the collisions are theirs. `second` may be null.
void check_collisions(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions);

/// The same, and both meshes as one.
ColouredMesh coloured_mesh(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions);

/// `polygons`: faces are the mesh's polygons.
void write_ply(std::ostream& out, const TriangleMesh& mesh, bool polygons);
void write_obj(std::ostream& out, const TriangleMesh& mesh, bool polygons);
void write_stl(std::ostream& out, const TriangleMesh& mesh, bool);
void write_off(std::ostream& out, const TriangleMesh& mesh, bool polygons);
void write_3mf(std::ostream& out, const TriangleMesh& mesh, bool);
void write_glb(std::ostream& out, const TriangleMesh& mesh, bool);
/// A world without colours.
void write_3mf(std::ostream& out, const WorldMesh& world);
void write_glb(std::ostream& out, const WorldMesh& world);

void write_coloured_ply(std::ostream& out, const ColouredMesh& coloured);
void write_coloured_obj(std::ostream& out, const ColouredMesh& coloured, const std::string& material_file);
/// Materials of the file above, which begin with this line.
void write_materials(std::ostream& out, std::span<const Material> materials);
inline constexpr std::string_view title_of_materials = "# Crumple: materials of free and of colliding triangles";
/// Writes both files, which appear or stay as they were. Throws as the public write_coloured does.
void write_coloured_obj(const std::filesystem::path& path, const ColouredMesh& coloured);
void write_coloured_glb(std::ostream& out, const ColouredMesh& coloured);
void write_coloured_3mf(std::ostream& out, const ColouredMesh& coloured);
/// `hit`: for each triangle of each body, which of the materials it has; without materials there are none.
void write_coloured_3mf(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit,
                        std::span<const Material> materials);
/// `hit` counts in the shades.
void write_shaded_glb(std::ostream& out, const ColouredMesh& coloured, std::span<const Colour> shades);
/// The same, with a node for each body.
void write_coloured_glb(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit,
                        std::span<const Material> materials);
/// A page of its own, or for a height in pixels a piece of one. The collisions are those of the meshes.
void write_html(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                const Intersections& collisions, int height = 0);
/// Writes a page that shows opaque triangles through translucent ones, and lines, each by its two ends.
void write_overlap_html(std::ostream& out, const ColouredMesh& coloured, std::vector<std::array<double, 3>> lines,
                        const std::string& caption);

/// Lower-case extension, with its dot; .obj for mesh.obj.gz.
std::string extension_of(const std::filesystem::path& path);
/// The format that an extension, in lower case and with its dot, names; automatic for none of them.
MeshFormat mesh_format_of(std::string_view extension);
PairFormat pair_format_of(std::string_view extension);
/// Whether meshes are written so, or those with colours.
bool holds_meshes(MeshFormat format);
bool has_colours(MeshFormat format);
/// Throws Error (invalid_argument) unless coloured meshes are written so, to a path or to a stream.
void check_has_colours(const std::filesystem::path& path, MeshFormat format);
void check_has_colours(MeshFormat format);

/// Throws unless the arrays have the right sizes, indices are in range and coordinates finite.
void validate(const TriangleMesh& mesh);

/// Calls f with a float or a double, the scalar type of the mesh that it returns.
template <class F>
TriangleMesh in_precision(Precision asked, ScalarType of_file, F&& f) {
    const bool single = asked == Precision::automatic ? of_file == ScalarType::float32 : asked == Precision::float32;
    return single ? f(float{}) : f(double{});
}

}  // namespace crumple::io
