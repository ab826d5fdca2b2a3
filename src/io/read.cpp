// Reads meshes and worlds: detects the format, by content first and by extension second, calls its reader, and does
// the steps that all formats share (archives, poses, limits, units).

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "base/float_environment.h"
#include "io/bytes/expanded_size.h"
#include "io/bytes/gzip.h"
#include "io/bytes/text.h"
#include "io/bytes/zip.h"
#include "io/formats.h"
#include "io/meshes/weld.h"
#include "io/scenes/3mf.h"
#include "io/scenes/body_names.h"
#include "io/scenes/gltf.h"
#include "io/scenes/gltf_file.h"
#include "io/scenes/world_mesh.h"

namespace crumple::io {

namespace {

enum class Format { ply, obj, stl, off };

Format format_of(const Source& source, const std::string& extension) {
    if (is_binary_stl(source)) return Format::stl;
    Scanner in(source, {.lines = true, .comments = true});
    if (in.next_line_with_items()) {
        const std::string_view word = in.word();
        if (word == "ply" && word.data() == source.text_begin()) return Format::ply;
        if (off_keyword(word)) return Format::off;
        if (starts_obj(word)) return Format::obj;
        if (word.size() == 5 && std::tolower(word[0]) == 's' && word.substr(1) == "olid") return Format::stl;
    }
    if (extension == ".ply") return Format::ply;
    if (extension == ".obj") return Format::obj;
    if (extension == ".stl") return Format::stl;
    if (extension == ".off") return Format::off;
    throw Error(ErrorCode::format,
                source.name() + ": neither its content nor its extension is that of PLY, OBJ, STL, OFF, glTF or 3MF",
                Element::byte, 0);
}

TriangleMesh read(const Source& source, Format format, const ReadOptions& options, Warnings& warnings) {
    switch (format) {
        case Format::ply:
            return read_ply(source, options, warnings);
        case Format::obj:
            return read_obj(source, options, warnings);
        case Format::stl:
            return read_stl(source, options, warnings);
        case Format::off:
            break;
    }
    return read_off(source, options, warnings);
}

/// True if the text begins with the byte order mark of UTF-16, or if exactly every second one of the first four bytes
/// is zero, as in ASCII text stored as UTF-16.
bool is_utf16(std::string_view text) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) return true;
    const auto is_zero = [&](std::size_t i) { return text[i] == 0; };
    return text.size() >= 4 && is_zero(0) != is_zero(1) && is_zero(0) == is_zero(2) && is_zero(1) == is_zero(3);
}

/// Throws Error (format) with a helpful message for content that no reader recognises: an empty file, a pointer of Git
/// LFS, or UTF-16.
void check_content(const Source& source) {
    const auto fail = [&](const char* what) { source.fail_at_byte(source.begin(), what); };
    if (source.text().find_first_not_of(" \t\r\n") == source.text().npos) fail("the file is empty");
    if (source.text().starts_with("version https://git-lfs"))
        fail("this is a pointer to a file that Git LFS keeps elsewhere; `git lfs pull` downloads the file");
    if (is_utf16(source.text()) && !is_binary_stl(source)) fail("this is text in UTF-16; save it as UTF-8");
}

bool names_mesh(const std::string& entry) {
    const std::string extension = extension_of(without_gzip_name(entry).string());
    if (entry.starts_with("__MACOSX/"))
        return false;  // macOS stores metadata of files there, under the files' own names
    return extension == ".glb" || extension == ".gltf" || holds_meshes(mesh_format_of(extension));
}

/// File, and the folder in which other files that it refers to are found; no folder for a stream or an archive entry.
struct File {
    Source source;
    std::optional<std::filesystem::path> folder;
};

/// Returns the one mesh of a zip archive that is not a 3MF file, and any other file unchanged. Throws Error (format).
File unpacked(File file) {
    const Source& source = file.source;
    if (!is_zip(source) || extension_of(source.name()) == ".3mf") return file;
    ZipReader archive(source, "3MF or zip");
    if (archive.has("_rels/.rels", true)) return file;
    std::vector<std::string> meshes;
    std::copy_if(archive.names().begin(), archive.names().end(), std::back_inserter(meshes), names_mesh);
    const auto fail = [&](const std::string& what) {
        throw Error(ErrorCode::format, source.name() + ": this is a zip archive but not a 3MF file, and " + what);
    };
    if (meshes.empty()) fail("it holds no mesh");
    if (meshes.size() > 1)
        fail("it holds " + std::to_string(meshes.size()) + " meshes, " + in_quotes(meshes[0]) +
             " the first; unpack it");
    const auto bytes = archive.expand(meshes[0], expansion_limit(source.text().size()));
    if (!bytes)
        fail(in_quotes(meshes[0]) + " is damaged, encrypted, compressed in a way that is not supported, or too large");
    Source mesh(*bytes, source.name() + '/' + meshes[0]);
    check_content(mesh);
    return {std::move(mesh), std::nullopt};
}

void check_has_properties(const Source& source, const ReadOptions& options, bool ply) {
    if (!options.group_property.empty() && !ply)
        throw Error(ErrorCode::invalid_argument, source.name() + ": only PLY files have properties", Element::option);
}

TriangleMesh read(const Source& source, const ReadOptions& options) {
    const FloatEnvironment environment;
    const Format format = format_of(source, extension_of(source.name()));
    check_has_properties(source, options, format == Format::ply);
    try {
        Warnings warnings(source, options.strict);
        TriangleMesh mesh = read(source, format, options, warnings);
        if (mesh.vertex_count() > INT32_MAX || mesh.triangle_count() > INT32_MAX) {
            throw Error(ErrorCode::format,
                        source.name() + ": it has more vertices or triangles than 32-bit ids can number");
        }
        if (options.weld == Weld::yes || (options.weld == Weld::automatic && format == Format::stl)) weld(mesh);
        if (mesh.triangles.empty() && mesh.lines.empty() && mesh.points.empty())
            warnings.of_file("it holds no triangles");
        mesh.warnings = warnings.take();
        return mesh;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its mesh does not fit in memory");
    }
}

bool is_scene(const Source& source) {
    const std::string extension = extension_of(source.name());
    return is_3mf(source, extension) || is_gltf(source, extension);
}

WorldMesh read_scene(const File& file, const ReadOptions& options) {
    const Source& source = file.source;
    const FloatEnvironment environment;
    check_has_properties(source, options, false);
    try {
        Warnings warnings(source, options.strict);
        WorldMesh world = is_3mf(source, extension_of(source.name()))
                              ? read_3mf(source, options, warnings)
                              : read_gltf(source, file.folder, options, warnings);
        if (world.bodies.empty())
            warnings.of_file("it holds no bodies");
        else if (world.triangle_count() == 0)
            warnings.of_file("it holds no triangles");
        if (const NamedBody* const far = find_far_body(world))
            warnings.of_file("body " + in_quotes(far->name) +
                             " is more than 1024 times its size away from the origin, "
                             "where float32, the file's precision, rounds its vertices: read it as float64");
        world.warnings = warnings.take();
        make_names_unique(world.bodies);
        return world;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its meshes do not fit in memory");
    }
}

/// Throws Error (format) if the bodies have too many triangles for the size of the file. A few lines can place a large
/// mesh many times: that is cheap in a world, but one joined mesh could exceed the memory.
void check_expansion(const Source& source, const WorldMesh& world) {
    constexpr std::int64_t always = std::int64_t{1} << 24, per_byte = 16;
    std::int64_t triangles = 0;
    for (const NamedBody& body : world.bodies)
        triangles += world.shapes[static_cast<std::size_t>(body.shape)].triangle_count();
    if (triangles > std::max(always, per_byte * static_cast<std::int64_t>(source.text().size())))
        throw Error(ErrorCode::format, source.name() + ": it refers to meshes so often that they have " +
                                           std::to_string(triangles) + " triangles, more than 16 per byte of the file");
}

/// Reads the bodies of a scene, posed, as one mesh. A single body with the identity pose keeps its vertices bit for
/// bit.
TriangleMesh read_posed(const File& file, const ReadOptions& options) {
    const Source& source = file.source;
    ReadOptions apart = options;
    if (options.weld == Weld::yes) apart.weld = Weld::no;
    WorldMesh world = read_scene(file, apart);
    check_expansion(source, world);
    const bool in_place = world.bodies.size() == 1 && world.bodies[0].pose == Pose{};
    try {
        TriangleMesh mesh = in_place ? std::move(world.shapes.at(0)) : posed_mesh(world);
        mesh.groups.clear();  // posed_mesh() sets them to the indices of bodies
        mesh.warnings = std::move(world.warnings);
        const auto is_finite = [](const auto& xyz) {
            return std::all_of(xyz.begin(), xyz.end(), [](auto x) { return std::isfinite(x); });
        };
        if (!std::visit(is_finite, mesh.vertices))
            throw Error(ErrorCode::format, source.name() + ": a transform makes a vertex overflow");
        if (options.weld == Weld::yes) weld(mesh);
        return mesh;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its mesh does not fit in memory");
    }
}

/// Converts a mesh or a world to the requested unit; Unit::unknown requests none.
template <class Mesh>
Mesh in_unit(Unit unit, const Source& source, Mesh mesh) {
    try {
        if (unit != Unit::unknown) convert_unit(mesh, unit);
        return mesh;
    } catch (const Error& error) {
        throw Error(ErrorCode::format, source.name() + ": " + error.what(), error.element, error.index);
    }
}

TriangleMesh read_mesh(File given, const ReadOptions& options) {
    check_content(given.source);
    const File file = unpacked(std::move(given));
    return in_unit(options.unit, file.source,
                   is_scene(file.source) ? read_posed(file, options) : read(file.source, options));
}

WorldMesh read_world(File given, const ReadOptions& options) {
    check_content(given.source);
    const File file = unpacked(std::move(given));
    if (is_scene(file.source)) return in_unit(options.unit, file.source, read_scene(file, options));
    WorldMesh world;
    world.shapes.push_back(read(file.source, options));
    world.warnings = std::move(world.shapes[0].warnings);
    world.bodies.push_back({without_gzip_name(file.source.name()).stem().string()});
    return in_unit(options.unit, file.source, std::move(world));
}

}  // namespace

WorldMesh read_world(const std::filesystem::path& path, const ReadOptions& options) {
    return read_world(File{Source(path), path.parent_path()}, options);
}

WorldMesh read_world(std::istream& in, const std::string& name, const ReadOptions& options) {
    return read_world(File{Source(in, name), std::nullopt}, options);
}

TriangleMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    return read_mesh(File{Source(path), path.parent_path()}, options);
}

TriangleMesh read_mesh(std::istream& in, const std::string& name, const ReadOptions& options) {
    return read_mesh(File{Source(in, name), std::nullopt}, options);
}

}  // namespace crumple::io
