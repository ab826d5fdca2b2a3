#pragma once

// One reader and one writer a format; what they have in common.

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "crumple/io.h"
#include "io/source.h"

namespace crumple::io {

TriangleMesh read_ply(const Source& source, const ReadOptions& options);
TriangleMesh read_obj(const Source& source, const ReadOptions& options);
TriangleMesh read_stl(const Source& source, const ReadOptions& options);  ///< three vertices a triangle, not welded
TriangleMesh read_off(const Source& source, const ReadOptions& options);

/// 84 bytes and 50 for each of the triangles that it announces: a file of text would need 7 GB for that.
bool is_binary_stl(const Source& source);
/// "OFF" with the prefixes that tell what a vertex has: ST, C, N, 4, n.
bool is_off_header(std::string_view word);
/// A statement that OBJ files begin with.
bool starts_obj(std::string_view word);

/// Triangles that the writers colour: one soup of one or two meshes, and which of its triangles collide.
struct ColouredMesh {
    TriangleMesh mesh;
    std::vector<std::uint8_t> hit;
};

/// Throws unless both meshes are sound and the collisions are theirs. `second` may be null.
ColouredMesh coloured_mesh(const TriangleMesh& mesh, const TriangleMesh* second, const Collisions& collisions);

struct Colour {
    std::uint8_t red, green, blue;
};
inline constexpr Colour free_colour{178, 178, 178};
inline constexpr Colour colliding_colour{213, 94, 0};  // vermilion: strong on grey, also to the colour-blind

void write_ply(std::ostream& out, const TriangleMesh& mesh);
void write_obj(std::ostream& out, const TriangleMesh& mesh);
void write_stl(std::ostream& out, const TriangleMesh& mesh);
void write_off(std::ostream& out, const TriangleMesh& mesh);

void write_coloured_ply(std::ostream& out, const ColouredMesh& coloured);
void write_coloured_obj(std::ostream& out, const ColouredMesh& coloured, const std::string& material_file);
void write_materials(std::ostream& out);
void write_coloured_glb(std::ostream& out, const ColouredMesh& coloured);

void write_pairs_json(std::ostream& out, const Collisions& collisions);
void write_pairs_npz(std::ostream& out, const Collisions& collisions);
std::vector<Pair> read_pairs_json(const Source& source);
std::vector<Pair> read_pairs_npz(const Source& source);

/// Lower-case extension, with its dot.
std::string extension_of(const std::filesystem::path& path);

/// Throws unless the arrays have the right sizes, indices are in range and coordinates finite.
void validate(const TriangleMesh& mesh);

/// Calls f with a float or a double, the scalar type of the mesh that it returns.
template <class F>
TriangleMesh in_precision(Precision asked, ScalarType of_file, F&& f) {
    const bool single = asked == Precision::automatic ? of_file == ScalarType::float32 : asked == Precision::float32;
    return single ? f(float{}) : f(double{});
}

}  // namespace crumple::io
