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

#include "crumple/clustering.h"
#include "crumple/export.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/world.h"

namespace crumple::io {

/// Precision of a file's coordinates in memory. `automatic` loses no bit: for PLY, binary or ascii, the type of its
/// coordinate properties, or float64 if they are integers or of different types; float32 for binary STL and glTF;
/// float64 for all other text formats.
enum class Precision : std::uint8_t { automatic, float32, float64 };

/// Merging of vertices at equal positions (-0 equals +0). `automatic` merges for STL, which has no shared vertices, and
/// for glTF, which repeats a vertex for each normal; it leaves other formats unchanged.
enum class Weld : std::uint8_t { automatic, yes, no };

/// Triangulation of polygons: n - 2 triangles for n corners. `fan`: all triangles share the first corner. `ears`: a fan
/// for convex polygons, and ear clipping, which makes no overlapping triangles, for concave ones; a polygon that
/// crosses itself becomes a fan, with a warning. Exact predicates classify polygons, projected along the axis in which
/// their Newell normal is largest.
enum class Triangulation : std::uint8_t { ears, fan };

/// Unit of a file's coordinates. 3MF states it (millimetre by default), glTF prescribes metre, other formats do not
/// have one.
enum class Unit : std::uint8_t { unknown, micrometre, millimetre, centimetre, inch, foot, metre };

/// Options of read_mesh() and read_world().
struct ReadOptions {
    Precision precision = Precision::automatic;
    Weld weld = Weld::automatic;
    std::string group_property = {};  ///< PLY: integer face property that holds the groups; empty: no groups
    Triangulation triangulation = Triangulation::ears;
    bool strict = false;  ///< true: an oddity of the file that deserves a warning is an Error instead
    /// OBJ: reads `l` and `p` elements, too; PLY without faces: its vertices are points.
    bool lines_and_points = false;
    /// Requested unit. Coordinates in another unit are converted to it; a file without a unit is assumed to have it.
    /// `unknown`: keeps the unit of the file.
    Unit unit = Unit::unknown;
};

/// Polygons that a file's triangles were cut from. All arrays are empty if each triangle is a face of the file.
struct Polygons {
    std::vector<std::int32_t> of_triangle;  ///< m: index of each triangle's polygon, ascending
    std::vector<std::int64_t> offsets;      ///< p + 1: polygon i has corners [offsets[i], offsets[i + 1])
    std::vector<std::int32_t> corners;      ///< vertices, in the order of the file

    /// True if each triangle is a face of the file.
    bool empty() const { return of_triangle.empty(); }
    /// Returns the number of polygons; 0 if the arrays are empty.
    std::int64_t count() const { return empty() ? 0 : static_cast<std::int64_t>(offsets.size()) - 1; }
};

/// Triangle soup that owns its arrays, with triangles in the order of the file's faces.
struct CRUMPLE_API TriangleMesh {
    std::variant<std::vector<float>, std::vector<double>> vertices;  ///< 3n coordinates
    std::vector<std::int32_t> triangles;                             ///< 3m indices
    std::vector<std::int32_t> groups = {};                           ///< m group ids, or empty
    Polygons polygons = {};                  ///< polygons of the file; written if WriteOptions::polygons is set
    std::vector<std::string> warnings = {};  ///< warnings about the file, one sentence each
    std::vector<Edge> lines = {};            ///< segments of lines, with ReadOptions::lines_and_points
    std::vector<std::int32_t> points = {};   ///< vertices of points, with ReadOptions::lines_and_points
    Unit unit = Unit::unknown;               ///< unit of the coordinates; .3mf and .glb store it

    /// Returns the number of vertices, n.
    std::int64_t vertex_count() const;
    /// Returns the number of triangles, m.
    std::int64_t triangle_count() const { return static_cast<std::int64_t>(triangles.size() / 3); }
    /// Returns the type of the coordinates.
    ScalarType precision() const;
    /// Returns a view, valid while this mesh is unchanged. Includes neither lines nor points (see features_of()).
    MeshView view() const;
};

/// Features of a mesh with lines or points, for MeshView::edges and MeshView::points.
struct MeshFeatures {
    std::vector<Edge> edges;           ///< edges of faces and lines, each once, a < b, in lexicographic order
    std::vector<std::int32_t> points;  ///< vertices that an edge or a point names, each once, ascending
};
/// Returns the edges and points of a mesh. O(n log n).
CRUMPLE_API MeshFeatures features_of(const TriangleMesh& mesh);

/// Reads PLY (ascii, both binary orders), OBJ, STL (ascii, binary), OFF, glTF or 3MF, or the single mesh in a zip
/// archive. Detects the format by content first, by extension second. All posed bodies of glTF and 3MF become one mesh.
/// Every number is rounded once, directly to the precision used; underflow becomes subnormal or zero.
///
/// Throws crumple::Error (file, format) that names the file and the line or byte: truncated, hostile or absurd content,
/// indices out of range, coordinates that are not finite or overflow the precision. Error::index is then a line,
/// counted from 1, or a byte, counted from 0. Never returns a mesh that lacks the rest of a truncated file. Skips
/// normals, colours and texture coordinates. docs/input.md lists what each format's reader accepts, warns about and
/// refuses.
///
/// Cost: one pass over the file, at hundreds of MB per second; the whole file is in memory during the call. A concave
/// polygon of n corners usually takes O(n log n), at worst O(n^2).
CRUMPLE_API TriangleMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a mesh from a stream, to its end. Uses `name` for the file in messages, and its extension to detect the
/// format.
CRUMPLE_API TriangleMesh read_mesh(std::istream& in, const std::string& name, const ReadOptions& options = {});

/// Body of a file: name, shape and pose.
struct NamedBody {
    std::string name;
    std::int32_t shape = 0;  ///< index into WorldMesh::shapes
    Pose pose = {};
};

/// Arrays behind a crumple::World.
struct WorldView {
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::vector<Pose> poses;

    /// Returns a view, valid while the arrays are unchanged.
    World world() const { return {shapes, bodies, poses}; }
};

/// World that owns its arrays. Several bodies may share a shape.
struct CRUMPLE_API WorldMesh {
    std::vector<TriangleMesh> shapes;
    std::vector<NamedBody> bodies;           ///< names are unique
    std::vector<std::string> warnings = {};  ///< warnings about the file, one sentence each
    Unit unit = Unit::unknown;               ///< unit of all shapes and of the poses' translations

    /// Returns the number of triangles of all bodies.
    std::int64_t triangle_count() const;
    /// Returns views, valid until the world changes. Shapes are named `first_name`, `first_name` + 1 and so on, so that
    /// a detector caches them (Shape::name); 0: no names.
    WorldView view(std::uint64_t first_name = 0) const;
};

/// Reads glTF 2.0 (.glb, .gltf) as a world: each node of the default scene that has a mesh is a body, in the order of
/// the file's nodes, with the node's name. Its pose is the product of the transforms from the root down to the node.
/// Meshes that refer to the same data are one shape. Reads 3MF, too: each mesh of a build item, or of its components,
/// is a body with the object's name. Any other mesh file is a world of one body with the identity pose, named like the
/// file without its extension.
///
/// Shapes of glTF are float32 unless Precision::float64 is requested, and so are posed vertices. glTF repeats a vertex
/// for each of its normals, so `Weld::automatic` merges vertices at equal positions. A missing name is replaced for
/// glTF by the mesh's name, or if that is missing by `node7` for node 7; for 3MF by the name of the innermost enclosing
/// object that has one, or by `object 7`; a second body of the same name becomes NAME_2. Throws as read_mesh does, also
/// for a node with a transform that is not finite or not affine, and for nodes in a cycle. docs/input.md lists what is
/// read, skipped and refused.
CRUMPLE_API WorldMesh read_world(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a world from a stream, to its end; glTF must contain its buffers.
CRUMPLE_API WorldMesh read_world(std::istream& in, const std::string& name, const ReadOptions& options = {});

/// Reads the poses of bodies in one or more configurations. A file has one row per pose: the first configuration's
/// poses of all bodies, in the order of `bodies` (their names, for messages), then those of the next configuration, and
/// so on. A row has 12 numbers, those of Pose::rows, or 16 that end with 0 0 0 1. A .npy file is an array of float32 or
/// float64 whose last dimension is 12 or 16, or whose last two are (3, 4) or (4, 4). Any other file is text, one row
/// per line, with commas or blanks between numbers; a first line of words, blank lines and comments (#) are skipped.
/// Throws crumple::Error (file, format) that names the row and its body: too few or too many numbers, numbers that are
/// not finite, a last configuration without all bodies.
CRUMPLE_API std::vector<Pose> read_poses(const std::filesystem::path& path, std::span<const std::string> bodies);

/// Reads poses from a stream, to its end. Uses `name` for the file in messages, and its extension to detect the format.
CRUMPLE_API std::vector<Pose> read_poses(std::istream& in, const std::string& name,
                                         std::span<const std::string> bodies);

/// Returns the short name of a unit: "um", "mm", "cm", "in", "ft" or "m"; "unknown" for Unit::unknown.
CRUMPLE_API const char* name_of(Unit unit);
/// Returns the unit of a short name, or of a long one: "inch", "millimeter", "millimetre". Throws crumple::Error
/// (invalid_argument) for other names.
CRUMPLE_API Unit unit_named(std::string_view name);

/// Converts coordinates to another unit, each rounded once to the mesh's precision. If the mesh's unit is unknown, sets
/// it and changes no coordinate. Rounding may break or create contacts. Throws crumple::Error (invalid_argument),
/// without a change, for Unit::unknown and for coordinates that overflow.
CRUMPLE_API void convert_unit(TriangleMesh& mesh, Unit to);
/// Converts all shapes, and the poses' translations.
CRUMPLE_API void convert_unit(WorldMesh& world, Unit to);

/// Returns all bodies as one mesh, body after body, with each vertex posed exactly as in Detector::find. The group of a
/// triangle is the index of its body. If a pose mirrors its body, swaps the last two corners of each triangle, so that
/// the outside stays outside.
CRUMPLE_API TriangleMesh posed_mesh(const WorldMesh& world);

/// Options of write_mesh().
struct WriteOptions {
    bool polygons = false;  ///< writes polygons instead of their triangles; .stl, .glb and .3mf support triangles only
};

/// Writes .ply (binary little endian), .obj, .stl (binary), .off, .glb or .3mf by extension. Throws crumple::Error
/// (file, invalid_argument, index_out_of_range, not_finite), and then leaves an existing file unchanged.
///
/// Coordinates keep every bit, except in .stl and .glb, which store float32; .stl shares no vertices. In .glb, a
/// float64 mesh far from the origin is stored relative to a translation of its node. .3mf stores the unit; .glb has a
/// node that scales to metres; the other formats have no unit. Numbers in text are the shortest decimals that are read
/// back as the same float64 numbers (the default precision for text). Only .ply stores groups, as the face property
/// `group`.
CRUMPLE_API void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                            const WriteOptions& options = {});

/// Mesh file formats; `automatic`: by extension.
enum class MeshFormat : std::uint8_t { automatic, ply, obj, stl, off, glb, html, threemf };

/// Writes to a stream, as ply, obj, stl, off, glb or 3mf. Also throws if the stream fails.
CRUMPLE_API void write_mesh(std::ostream& out, const TriangleMesh& mesh, MeshFormat format,
                            const WriteOptions& options = {});

/// Writes a world as .3mf or .glb: bodies are named objects or nodes with their poses, and share the meshes of their
/// shapes. An unknown unit becomes millimetre in .3mf, which needs one, and metre in .glb. Throws as write_mesh does,
/// and for bodies without a shape or with a pose that is not finite.
CRUMPLE_API void write_world(const std::filesystem::path& path, const WorldMesh& world);

/// Writes a world to a stream, as glb or 3mf.
CRUMPLE_API void write_world(std::ostream& out, const WorldMesh& world, MeshFormat format = MeshFormat::threemf);

/// Writes a mesh with colliding triangles coloured, the others grey: .ply, .obj (with a .mtl file), .glb, .3mf or
/// .html. `second` may be null; its triangles follow those of the first mesh. Throws as write_mesh does, also if a .mtl
/// file of the same name exists that Crumple has not written: it is not replaced.
///
/// .ply colours both faces and vertices of colliding faces, because some viewers show only one of the two. .glb stores
/// float32; a float64 mesh far from the origin is stored relative to a translation of its node. .html is a page that
/// shows the meshes and contacts in WebGL, with rotation and zoom, without network access; about 100 bytes per
/// triangle.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Intersections& collisions);

/// Writes to a stream, as ply, glb, 3mf or html.
CRUMPLE_API void write_coloured(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Intersections& collisions, MeshFormat format);

/// Writes a world with its colliding triangles coloured. .glb and .3mf keep bodies with names and poses, and shared
/// shapes; the other formats contain posed_mesh(world). The collisions must be those of the world's view, with
/// IntersectionQuery::index. Throws as write_coloured does for a mesh, also for collisions of another world.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const WorldMesh& world,
                                const Intersections& collisions);

/// Writes to a stream, as ply, glb, 3mf or html.
CRUMPLE_API void write_coloured(std::ostream& out, const WorldMesh& world, const Intersections& collisions,
                                MeshFormat format);

/// Writes a world with its overlaps visible from outside. The parts of a body's surface that lie inside another body of
/// the same row, or inside the same body where it overlaps itself, are opaque in a strong colour; everything else is
/// translucent. To this end the bodies of all rows are cut along the curves in which they cross, so their triangles and
/// vertices change; a detector with `options` searches for these curves. Overlaps of Output::body_pairs suffice. Rows
/// with the relation `undefined` have no coloured parts inside. Without rows everything is translucent.
///
/// .glb and .3mf have bodies with names, .obj and .html one mesh; .html also shows the curves. .ply has no
/// transparency: it contains only the surface of the overlaps, which may be empty, with the bodies as groups. Throws as
/// write_coloured does for collisions, also for overlaps without rows or of another world, and as Detector::find does.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const WorldMesh& world, const Overlaps& overlaps,
                                const Options& options = {});

/// Writes to a stream, as ply, glb, 3mf or html.
CRUMPLE_API void write_coloured(std::ostream& out, const WorldMesh& world, const Overlaps& overlaps, MeshFormat format,
                                const Options& options = {});

/// Returns an HTML fragment, `height` pixels high, with the content of the page that write_coloured writes as .html. A
/// page may contain several.
CRUMPLE_API std::string to_html(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions,
                                int height = 480);

/// Groups of triangles that a picture of a clustering distinguishes by colours.
enum class ColouredBy : std::uint8_t { clusters, leaves };

/// Writes a mesh with each triangle in the colour of its nearest cluster or leaf, darker if it belongs to several of
/// them, and grey if the search leaves it out: .ply, .obj (with a .mtl file), .glb, .3mf or .html, which also shows the
/// sweep direction of each leaf as a line through the leaf. There are 64 colours; leaves beyond these repeat them.
/// `second` may be null. The clustering must be that of the meshes. Throws as write_coloured does for collisions.
CRUMPLE_API void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                                const Clustering& clustering, ColouredBy groups);

/// Writes the arrays of a clustering, under the names of its members, as .json or .npz; `axes` has 9 numbers per leaf.
/// Throws Error (file, invalid_argument).
CRUMPLE_API void write_clustering(const std::filesystem::path& path, const Clustering& clustering);

/// Converts collisions of triangles to collisions of the files' polygons: ids, offsets and hits are those of polygons,
/// each pair once. (p, p) is a polygon with two colliding triangles. The collisions must be those of all triangles of
/// the meshes; `second` may be null. Contacts are dropped: they belong to triangles. O(pairs log pairs). Throws
/// crumple::Error (invalid_argument) unless the collisions belong to these meshes.
CRUMPLE_API Intersections by_polygon(const TriangleMesh& mesh, const TriangleMesh* second,
                                     const Intersections& collisions);

/// Writes a file atomically: completely or not at all. Throws crumple::Error (file).
CRUMPLE_API void write_bytes(const std::filesystem::path& path, std::string_view bytes);

/// Animation of frames with colliding triangles coloured, written as one .glb that common viewers play. Frames may
/// differ in everything, including topology. Holds all frames in memory: 12 bytes per vertex and 12 per triangle.
class CRUMPLE_API ColouredAnimation {
   public:
    /// Throws Error (invalid_argument) unless 0 < frames_per_second <= 10^6.
    explicit ColouredAnimation(double frames_per_second = 30);
    ~ColouredAnimation();
    ColouredAnimation(ColouredAnimation&&) noexcept;
    ColouredAnimation& operator=(ColouredAnimation&&) noexcept;

    /// Adds a frame, coloured as by write_coloured. Throws as write_coloured does, also if the file would exceed the 4
    /// GiB limit of .glb; earlier frames are kept.
    void add(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions);

    /// Writes the frames added so far; more may follow. Throws crumple::Error (file, invalid_argument).
    void write(const std::filesystem::path& path);
    /// Writes the same bytes to a stream. Also throws if the stream fails.
    void write(std::ostream& out);

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// File formats of lists.
enum class PairFormat : std::uint8_t {
    automatic,  ///< by extension
    txt,        ///< `i j` per line; with contacts followed by ` kind x y z ...`
    csv,        ///< a header line, then `a,b`; with contacts also `kind,points` and six columns of x, y and z
    json,       ///< pairs, contacts, statistics
    npz,        ///< NumPy arrays: pairs, offsets, hit, hit_second, contact_kinds, contact_offsets, contact_points
};

/// Writes the pairs, with contacts if there are any. Numbers are the shortest decimals that are read back as the same
/// float64. Throws crumple::Error (file, invalid_argument), and then leaves an existing file unchanged.
CRUMPLE_API void write_pairs(const std::filesystem::path& path, const Intersections& collisions,
                             PairFormat format = PairFormat::automatic);

/// Writes pairs to a stream; `automatic` is txt.
CRUMPLE_API void write_pairs(std::ostream& out, const Intersections& collisions,
                             PairFormat format = PairFormat::automatic);

/// Writes pairs block by block (Detector::stream), as .txt or .csv. The file is the same as write_pairs writes for all
/// blocks.
class CRUMPLE_API PairWriter {
   public:
    /// `contacts`: true if the blocks have contacts. Throws crumple::Error (file; invalid_argument for other formats).
    explicit PairWriter(const std::filesystem::path& path, bool contacts, PairFormat format = PairFormat::automatic);
    /// Writes to a stream; `automatic` is txt.
    explicit PairWriter(std::ostream& out, bool contacts, PairFormat format = PairFormat::automatic);
    ~PairWriter();
    PairWriter(PairWriter&&) noexcept;
    PairWriter& operator=(PairWriter&&) noexcept;

    /// Writes a block. Throws crumple::Error (file), as commit() does.
    void add(const Intersections& block);
    /// Completes the file after the last block. Without this call an existing file stays unchanged.
    void commit();

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Reads the pairs of a file, in the file's order. By extension: .csv, .json (the member `pairs`), .npz (the array
/// `pairs`) and .npy, of 32 or 64 bits. Any other file is text: the first two numbers of each line, with or without a
/// comma between; the rest of the line, blank lines and comments (#) are skipped. Throws crumple::Error (file, format)
/// that names the place.
CRUMPLE_API std::vector<Pair> read_pairs(const std::filesystem::path& path);

/// Reads pairs from a stream, to its end. Uses `name` for the file in messages, and its extension to detect the format.
CRUMPLE_API std::vector<Pair> read_pairs(std::istream& in, const std::string& name);

}  // namespace crumple::io
