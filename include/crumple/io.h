#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "crumple/export.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/world.h"

namespace crumple::io {

/// Precision in which a file's coordinates are held. `automatic` loses no bit of the file: PLY (ascii, too) by its
/// property type (mixed or integer: float64), binary STL and glTF float32, other text float64.
enum class Precision : std::uint8_t { automatic, float32, float64 };

/// STL names no vertices, and glTF repeats them for each normal; `automatic` welds these two by exact position (-0
/// equals +0) and leaves the other formats alone.
enum class Weld : std::uint8_t { automatic, yes, no };

/// How polygons are cut into triangles, n - 2 for n corners. `fan`: from the first corner. `ears`: the same for a
/// convex polygon; a concave one is cut without overlaps, by clipping ears, and one that crosses itself is fanned, with
/// a warning. Which it is, exact predicates tell, along the axis in which the polygon's Newell normal is largest.
enum class Triangulation : std::uint8_t { ears, fan };

/// Unit of a file's coordinates, as 3MF states it (millimetre unless it says another) and glTF prescribes it (metre).
/// The other formats do not say.
enum class Unit : std::uint8_t { unknown, micrometre, millimetre, centimetre, inch, foot, metre };

struct ReadOptions {
    Precision precision = Precision::automatic;
    Weld weld = Weld::automatic;
    std::string group_property = {};  ///< PLY: integer face property that holds the groups; empty: none
    Triangulation triangulation = Triangulation::ears;
    bool strict = false;            ///< what would be a warning is an error
    bool lines_and_points = false;  ///< OBJ: also read what `l` and `p` name; PLY without faces: its vertices
    Unit unit = Unit::unknown;      ///< asked for: files that do not say theirs are taken for it, others converted
};

/// The polygons that a file's triangles were cut from. All arrays are empty where each triangle is a face of the file.
struct Polygons {
    std::vector<std::int32_t> of_triangle;  ///< m: the polygon that each triangle is a part of, ascending
    std::vector<std::int64_t> offsets;      ///< p + 1: corners of polygon i are corners[offsets[i]] to [offsets[i + 1]]
    std::vector<std::int32_t> corners;      ///< vertices, in the order of the file

    bool empty() const { return of_triangle.empty(); }
    std::int64_t count() const { return empty() ? 0 : static_cast<std::int64_t>(offsets.size()) - 1; }
};

/// A triangle soup that owns its arrays, triangles in the order of the file's faces.
struct CRUMPLE_API TriangleMesh {
    std::variant<std::vector<float>, std::vector<double>> vertices;  ///< 3n coordinates
    std::vector<std::int32_t> triangles;                             ///< 3m indices
    std::vector<std::int32_t> groups = {};                           ///< m ids or empty
    Polygons polygons = {};                                          ///< of the file; written where WriteOptions asks
    std::vector<std::string> warnings = {};                          ///< what was odd about the file, a sentence each
    std::vector<Edge> lines = {};                                    ///< segments of lines, as ReadOptions asks for
    std::vector<std::int32_t> points = {};                           ///< the same of points
    Unit unit = Unit::unknown;                                       ///< of the coordinates; .3mf and .glb keep it

    std::int64_t vertex_count() const;
    std::int64_t triangle_count() const { return static_cast<std::int64_t>(triangles.size() / 3); }
    ScalarType precision() const;
    MeshView view() const;
};

/// Edges and points of a mesh with lines or points, for MeshView::edges and MeshView::points: edges of faces and lines,
/// each once, a < b, in lexicographic order; vertices that these and points name, ascending.
struct MeshFeatures {
    std::vector<Edge> edges;
    std::vector<std::int32_t> points;
};
CRUMPLE_API MeshFeatures features_of(const TriangleMesh& mesh);

/// Reads PLY (ascii, both binary orders), OBJ, STL (ascii, binary), OFF, glTF or 3MF, told apart by content first and
/// extension second, or the one mesh in a zip archive. Of glTF and 3MF all bodies, where they are, are one mesh. Every
/// number is rounded once, directly to the precision used; what underflows becomes subnormal or zero.
///
/// Throws crumple::Error (file, format) that names the file and the line or byte: truncated, hostile or absurd content,
/// indices out of range, coordinates that are not finite or overflow the precision. Error::index is then a line,
/// counted from 1, or a byte, counted from 0. Never answers with part of a mesh that a file announces. Normals, colours
/// and texture coordinates are skipped. What each format's reader accepts, warns of and refuses: docs/input.md.
///
/// One pass over the file, which is held in memory meanwhile: hundreds of MB a second. A concave polygon of n corners
/// takes O(n log n) as a rule, O(n^2) at worst.
CRUMPLE_API TriangleMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same of a stream, to its end. `name` stands in messages, and its extension for the file's.
CRUMPLE_API TriangleMesh read_mesh(std::istream& in, const std::string& name, const ReadOptions& options = {});

/// A body of a file: its name, which shape it has, and where that is.
struct NamedBody {
    std::string name;
    std::int32_t shape = 0;  ///< index into WorldMesh::shapes
    Pose pose = {};
};

/// Arrays that a crumple::World views.
struct WorldView {
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::vector<Pose> poses;

    World world() const { return {shapes, bodies, poses}; }
};

/// A world that owns its arrays. Several bodies may have one shape.
struct CRUMPLE_API WorldMesh {
    std::vector<TriangleMesh> shapes;
    std::vector<NamedBody> bodies;           ///< every name once
    std::vector<std::string> warnings = {};  ///< what was odd about the file, a sentence each
    Unit unit = Unit::unknown;               ///< of shapes, which have the same, and of the poses' translations

    /// Number of triangles of all bodies.
    std::int64_t triangle_count() const;
    /// Valid while the world is as it is. Shapes are named `first_name`, `first_name` + 1 and so on, so that a detector
    /// remembers them (Shape::name); 0: they have no names.
    WorldView view(std::uint64_t first_name = 0) const;
};

/// Reads glTF 2.0 (.glb, .gltf) as a world: each node of the default scene that has a mesh is a body, in the order of
/// the file's nodes, with the node's name and its transform from the root. Meshes over the same data are one shape.
/// Reads 3MF, too: each mesh that an item of the build names, itself or by components, is a body, with the object's
/// name. Any other mesh file is a world of one body in place, named like the file without its extension.
///
/// Shapes of glTF are float32 unless Precision::float64 is asked for, and so are posed vertices. glTF repeats a vertex
/// for each of its normals, so `Weld::automatic` welds by exact position. Names that are missing are those of the
/// meshes, or node7, of 3MF those of the objects around, or `object 7`; the second of a name becomes NAME_2. Throws as
/// read_mesh does, also for a node with a transform that is not finite or not affine, and for nodes in a cycle.
/// docs/input.md tells what is read, skipped and refused.
CRUMPLE_API WorldMesh read_world(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same of a stream, to its end; glTF must hold its buffers itself.
CRUMPLE_API WorldMesh read_world(std::istream& in, const std::string& name, const ReadOptions& options = {});

/// Reads poses, a row for each of `bodies` (their names) in turn, configuration after configuration. A row is 12
/// numbers, those of Pose::rows, or 16 that end with 0 0 0 1. .npy by extension: float32 or float64, of a shape that
/// ends with 12 or 3, 4 (16 or 4, 4); any other file is text, a row a line, with commas or blanks between its numbers;
/// a first line of words, blank lines and comments (#) are skipped. Throws crumple::Error (file, format) that names the
/// row and its body: too few or too many numbers, numbers that are not finite, a last configuration that lacks bodies.
CRUMPLE_API std::vector<Pose> read_poses(const std::filesystem::path& path, std::span<const std::string> bodies);

/// The same of a stream, to its end. `name` stands in messages, and its extension for the file's.
CRUMPLE_API std::vector<Pose> read_poses(std::istream& in, const std::string& name,
                                         std::span<const std::string> bodies);

/// Short name of a unit: "um", "mm", "cm", "in", "ft", "m"; "unknown".
CRUMPLE_API const char* name_of(Unit unit);
/// Unit by such a name, or by its long one: "inch", "millimeter", "millimetre". Throws crumple::Error
/// (invalid_argument).
CRUMPLE_API Unit unit_named(std::string_view name);

/// Brings coordinates to another unit, each rounded once to the mesh's precision; an unknown unit is stated, and no
/// coordinate changes. What touched need not touch afterwards, and what did not may. Throws crumple::Error
/// (invalid_argument) for Unit::unknown and, as the mesh was, for coordinates that overflow.
CRUMPLE_API void convert_unit(TriangleMesh& mesh, Unit to);
/// The same of all shapes, and of the poses' translations.
CRUMPLE_API void convert_unit(WorldMesh& world, Unit to);

/// All bodies as one mesh, one after the other, with each vertex where Detector::find has it; groups are the bodies.
/// A pose that mirrors swaps the last two corners of each triangle, so that what was outside stays outside.
CRUMPLE_API TriangleMesh posed_mesh(const WorldMesh& world);

struct WriteOptions {
    bool polygons = false;  ///< the mesh's polygons instead of their triangles; .stl, .glb and .3mf hold triangles only
};

/// Writes .ply (binary little endian), .obj, .stl (binary), .off, .glb or .3mf by extension. Throws crumple::Error
/// (file, invalid_argument, index_out_of_range, not_finite); the file then stays as it was.
///
/// Coordinates keep every bit, except in .stl and .glb, which hold float32; .stl shares no vertices. A mesh of float64
/// far from the origin is moved there in .glb, by its node's translation. .3mf keeps the unit, and so does .glb, by a
/// node that scales to metres; the other formats have none. Text holds the shortest
/// decimals that give the same numbers back as float64, the precision that it is read in by default. Groups are kept by
/// .ply only, as the face property `group`.
CRUMPLE_API void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                            const WriteOptions& options = {});

enum class MeshFormat : std::uint8_t { automatic, ply, obj, stl, off, glb, html, threemf };

/// The same to a stream, as ply, obj, stl, off, glb or 3mf. Throws as well if the stream fails.
CRUMPLE_API void write_mesh(std::ostream& out, const TriangleMesh& mesh, MeshFormat format,
                            const WriteOptions& options = {});

/// Writes a world as .3mf or .glb: bodies are objects or nodes with names, put where their poses have them, and share
/// the meshes of their shapes. An unknown unit is millimetre in .3mf, which has to name one, and metre in .glb. Throws
/// as write_mesh does, and for bodies without a shape or with a pose that is not finite.
CRUMPLE_API void write_world(const std::filesystem::path& path, const WorldMesh& world);

/// The same to a stream, as glb or 3mf.
CRUMPLE_API void write_world(std::ostream& out, const WorldMesh& world, MeshFormat format = MeshFormat::threemf);

/// Writes a mesh with colliding triangles coloured, the others grey: .ply, .obj (with .mtl beside it), .glb, .3mf or
/// .html.
/// `second` may be null; its triangles follow those of the first. Throws as write_mesh does, also if the .mtl beside an
/// .obj holds other materials than those that this function writes: these are not replaced.
///
/// .ply colours faces, and vertices of colliding faces, because some viewers show only either. .glb holds float32: a
/// float64 mesh far from the origin is moved there, by its node's translation. .html is a page that shows the meshes
/// and contacts in WebGL, to turn and zoom, without a network; about 100 bytes a triangle.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Intersections& collisions);

/// The same to a stream, as ply, glb, 3mf or html.
CRUMPLE_API void write_coloured(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Intersections& collisions, MeshFormat format);

/// A world with its colliding triangles coloured. .glb and .3mf keep bodies, with names and poses, and shapes that
/// they share; the other formats hold the mesh that posed_mesh makes. The collisions are those of the world's view,
/// with IntersectionQuery::index. Throws as write_coloured does, also for collisions of another world.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const WorldMesh& world,
                                const Intersections& collisions);

/// The same to a stream, as ply, glb, 3mf or html.
CRUMPLE_API void write_coloured(std::ostream& out, const WorldMesh& world, const Intersections& collisions,
                                MeshFormat format);

/// Writes a world with its overlaps visible from outside: what lies inside another body of a row, or inside the same
/// body a second time, is opaque and in a strong colour, all else translucent. Bodies of rows are cut for that along
/// the curves in which they cross, which are searched anew, by a detector with these options; their triangles and
/// vertices are other ones than before. Overlaps of Output::body_pairs suffice. Rows of surfaces that are not closed
/// have no inside. Without rows all is translucent.
///
/// .glb and .3mf have bodies with names, .obj and .html one mesh; .html also shows the curves. .ply knows nothing
/// translucent: it holds the surface of the overlaps alone, which may be empty, with the bodies as groups. Throws as
/// write_coloured does for collisions, also for overlaps without rows or of another world, and as Detector::find.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const WorldMesh& world, const Overlaps& overlaps,
                                const Options& options = {});

/// The same to a stream, as ply, glb, 3mf or html.
CRUMPLE_API void write_coloured(std::ostream& out, const WorldMesh& world, const Overlaps& overlaps, MeshFormat format,
                                const Options& options = {});

/// A piece of HTML as high as this many pixels, of which a page may hold several; otherwise as write_coloured makes it.
CRUMPLE_API std::string to_html(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions,
                                int height = 480);

/// Converts collisions of triangles to those of polygons of the files: ids, offsets and hits are those of polygons,
/// each pair once. (p, p) is a polygon of which two triangles collide. The collisions are those of all triangles of the
/// meshes; `second` may be null. Contacts are left out: they belong to triangles. O(pairs log pairs). Throws
/// crumple::Error (invalid_argument) unless the collisions are of these meshes.
CRUMPLE_API Intersections by_polygon(const TriangleMesh& mesh, const TriangleMesh* second,
                                     const Intersections& collisions);

/// Writes bytes into a file, which appears whole or stays as it was. Throws crumple::Error (file).
CRUMPLE_API void write_bytes(const std::filesystem::path& path, std::string_view bytes);

/// Frames with their colliding triangles coloured, as one animated .glb that common viewers play. Frames may differ in
/// everything, their topology as well. Holds all frames in memory: 12 bytes a vertex and 12 a triangle each.
class CRUMPLE_API ColouredAnimation {
   public:
    /// Throws Error (invalid_argument) unless 0 < frames_per_second <= 10^6.
    explicit ColouredAnimation(double frames_per_second = 30);
    ~ColouredAnimation();
    ColouredAnimation(ColouredAnimation&&) noexcept;
    ColouredAnimation& operator=(ColouredAnimation&&) noexcept;

    /// One more frame, as for write_coloured. Throws as it does, also if the file would exceed the 4 GiB that .glb
    /// holds; the frames before are kept.
    void add(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions);

    /// Writes the frames so far; others may follow. Throws crumple::Error (file, invalid_argument).
    void write(const std::filesystem::path& path);
    void write(std::ostream& out);

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
CRUMPLE_API void write_pairs(const std::filesystem::path& path, const Intersections& collisions,
                             PairFormat format = PairFormat::automatic);

/// The same to a stream; `automatic` is txt.
CRUMPLE_API void write_pairs(std::ostream& out, const Intersections& collisions,
                             PairFormat format = PairFormat::automatic);

/// Pairs written block by block (Detector::stream), as .txt or .csv; together they are what write_pairs writes.
class CRUMPLE_API PairWriter {
   public:
    /// `contacts`: whether the blocks have them. Throws crumple::Error (file; invalid_argument for other formats).
    explicit PairWriter(const std::filesystem::path& path, bool contacts, PairFormat format = PairFormat::automatic);
    /// To a stream; `automatic` is txt.
    explicit PairWriter(std::ostream& out, bool contacts, PairFormat format = PairFormat::automatic);
    ~PairWriter();
    PairWriter(PairWriter&&) noexcept;
    PairWriter& operator=(PairWriter&&) noexcept;

    /// Throws crumple::Error (file), also at commit().
    void add(const Intersections& block);
    /// After the last block: the file is there. Without it, what was at the path stays as it was.
    void commit();

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Reads the pairs of a file, in its order: .csv, .json (the member `pairs`), .npz (the array `pairs`) and .npy, of 32
/// or 64 bits, by extension; any other is text, the first two numbers of each line, with or without a comma between,
/// with what follows them, blank lines and comments (#) skipped. Throws crumple::Error (file, format) that names the
/// place.
CRUMPLE_API std::vector<Pair> read_pairs(const std::filesystem::path& path);

/// The same of a stream, to its end. `name` stands in messages, and its extension for the file's.
CRUMPLE_API std::vector<Pair> read_pairs(std::istream& in, const std::string& name);

}  // namespace crumple::io
