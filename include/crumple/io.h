#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "crumple/collisions.h"
#include "crumple/mesh.h"

namespace crumple::io {

/// Precision in which a file's coordinates are held. `automatic` loses no bit of the file: PLY (ascii, too) by its
/// property type (mixed or integer: float64), binary STL float32, other text float64.
enum class Precision : std::uint8_t { automatic, float32, float64 };

/// STL names no vertices; `automatic` welds it by exact position (-0 equals +0) and leaves the other formats alone.
enum class Weld : std::uint8_t { automatic, yes, no };

struct ReadOptions {
    Precision precision = Precision::automatic;
    Weld weld = Weld::automatic;
    std::string group_property = {};  ///< PLY: integer face property that holds the groups; empty: none
};

/// A triangle soup that owns its arrays. Polygons of the file are fanned from their first corner, in file order.
struct TriangleMesh {
    std::variant<std::vector<float>, std::vector<double>> vertices;  ///< 3n coordinates
    std::vector<std::int32_t> triangles;                             ///< 3m indices
    std::vector<std::int32_t> groups;                                ///< m ids or empty

    std::int64_t vertex_count() const;
    std::int64_t triangle_count() const { return static_cast<std::int64_t>(triangles.size() / 3); }
    ScalarType precision() const;
    MeshView view() const;
};

/// Reads PLY (ascii, both binary orders), OBJ, STL (ascii, binary) or OFF, told apart by content first and extension
/// second. Every number is rounded once, directly to the precision used; what underflows becomes subnormal or zero.
///
/// Throws crumple::Error (file, format) that names the file and the line or byte: truncated, hostile or absurd content,
/// faces with fewer than three corners, indices out of range, coordinates that are not finite or overflow the
/// precision. Error::index is then a line, counted from 1, or a byte, counted from 0. Never answers with part of a mesh
/// that a file announces. Normals, colours and texture coordinates are skipped.
///
/// One pass over the file, which is held in memory meanwhile: hundreds of MB a second.
TriangleMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes .ply (binary little endian), .obj, .stl (binary) or .off by extension. Throws crumple::Error (file,
/// invalid_argument, index_out_of_range, not_finite); the file then stays as it was.
///
/// Coordinates keep every bit, except in .stl, which holds float32 and no shared vertices. Text holds the shortest
/// decimals that give the same number back in the mesh's own precision: read a float32 mesh's .obj or .off with
/// Precision::float32. Groups are kept by .ply only, as the face property `group`.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

/// Writes a mesh with colliding triangles coloured, the others grey: .ply, .obj (with .mtl beside it) or .glb. `second`
/// may be null; its triangles follow those of the first. Throws as write_mesh does.
///
/// .ply colours faces, and vertices of colliding faces, because some viewers show only either. .glb holds float32: a
/// float64 mesh far from the origin is moved there, by its node's translation.
void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                    const Collisions& collisions);

/// Frames with their colliding triangles coloured, as one animated .glb that common viewers play. Frames may differ in
/// everything, their topology as well. Holds all frames in memory: 12 bytes a vertex and 12 a triangle each.
class ColouredAnimation {
   public:
    /// Throws Error (invalid_argument) unless 0 < frames_per_second <= 10^6.
    explicit ColouredAnimation(double frames_per_second = 30);
    ~ColouredAnimation();
    ColouredAnimation(ColouredAnimation&&) noexcept;
    ColouredAnimation& operator=(ColouredAnimation&&) noexcept;

    /// One more frame, as for write_coloured. Throws as it does, also if the file would exceed the 4 GiB that .glb
    /// holds; the frames before are kept.
    void add(const TriangleMesh& mesh, const TriangleMesh* second, const Collisions& collisions);

    /// Writes the frames so far; others may follow. Throws crumple::Error (file, invalid_argument).
    void write(const std::filesystem::path& path);

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

enum class PairFormat : std::uint8_t {
    automatic,  ///< by extension
    txt,        ///< `i j` a line; with contacts ` kind x y z ...` follows
    csv,        ///< a header line, then `a,b`; with contacts also `kind,points` and six columns of x, y and z
    json,       ///< pairs, contacts, statistics
    npz,        ///< NumPy arrays: pairs, offsets, hit, hit_second, contact_kinds, contact_offsets, contact_points
};

/// Writes the pairs, and contacts if there are any. Numbers are the shortest decimals that give the same float64 back.
/// Throws crumple::Error (file, invalid_argument); the file then stays as it was.
void write_pairs(const std::filesystem::path& path, const Collisions& collisions,
                 PairFormat format = PairFormat::automatic);

/// The same to a stream; `automatic` is txt.
void write_pairs(std::ostream& out, const Collisions& collisions, PairFormat format = PairFormat::automatic);

/// Reads the pairs of a file, in its order: .csv, .json (the member `pairs`) and .npz (the array `pairs`, of 32 or 64
/// bits) by extension, as write_pairs writes them; any other is text, the first two numbers of each line, with what
/// follows them, blank lines and comments (#) skipped. Throws crumple::Error (file, format) that names the place.
std::vector<Pair> read_pairs(const std::filesystem::path& path);

}  // namespace crumple::io
