// Which format a file has, by its content first and its extension second, and what all formats have in common.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include "base/float_environment.h"
#include "io/3mf.h"
#include "io/formats.h"
#include "io/gltf.h"
#include "io/gltf_file.h"
#include "io/gzip.h"
#include "io/names.h"
#include "io/text.h"
#include "io/weld.h"

namespace crumple::io {

namespace {

enum class Format { ply, obj, stl, off };

Format format_of(const Source& source, const std::string& extension) {
    if (is_gltf(source, extension))
        throw Error(ErrorCode::format,
                    source.name() + ": glTF is a scene of bodies, not one mesh (read_world, --groups bodies)",
                    Element::byte, 0);
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
                source.name() + ": neither content nor extension are those of PLY, OBJ, STL, OFF or 3MF", Element::byte,
                0);
}

TriangleMesh read(const Source& source, Format format, const ReadOptions& options, Warnings& warnings) {
    switch (format) {
        case Format::ply:
            return read_ply(source, options, warnings);
        case Format::obj:
            return read_obj(source, options, warnings);
        case Format::stl:
            return read_stl(source, options, warnings);
        default:
            return read_off(source, options, warnings);
    }
}

void check_not_empty(const Source& source) {
    if (source.text().find_first_not_of(" \t\r\n") == source.text().npos)
        source.fail_at_byte(source.begin(), "the file is empty");
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
            throw Error(ErrorCode::format, source.name() + ": more vertices or triangles than 32-bit ids can name");
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

/// read(warnings) gives the world.
template <class Read>
WorldMesh read_scene(const Source& source, const ReadOptions& options, Read read) {
    const FloatEnvironment environment;
    check_has_properties(source, options, false);
    try {
        Warnings warnings(source, options.strict);
        WorldMesh world = read(warnings);
        if (world.bodies.empty()) warnings.of_file("it holds no bodies");
        world.warnings = warnings.take();
        make_names_unique(world.bodies);
        return world;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its meshes do not fit in memory");
    }
}

WorldMesh read_3mf(const Source& source, const ReadOptions& options) {
    return read_scene(source, options, [&](Warnings& warnings) { return read_3mf(source, options, warnings); });
}

/// A few lines may name a large mesh often: as a world that is nothing, as one mesh more than memory holds.
void check_expansion(const Source& source, const WorldMesh& world) {
    constexpr std::int64_t always = std::int64_t{1} << 24, per_byte = 16;
    std::int64_t triangles = 0;
    for (const NamedBody& body : world.bodies)
        triangles += world.shapes[static_cast<std::size_t>(body.shape)].triangle_count();
    if (triangles > std::max(always, per_byte * static_cast<std::int64_t>(source.text().size())))
        throw Error(ErrorCode::format, source.name() + ": the build names meshes so often that they have " +
                                           std::to_string(triangles) +
                                           " triangles, more than 16 a byte of the file; read them as bodies");
}

/// The bodies of a 3MF file, where they are; one that has not been moved keeps its bits.
TriangleMesh read_posed(const Source& source, const ReadOptions& options) {
    ReadOptions apart = options;
    apart.weld = Weld::no;
    WorldMesh world = read_3mf(source, apart);
    check_expansion(source, world);
    const bool in_place = world.bodies.size() == 1 && world.bodies[0].pose == Pose{};
    try {
        TriangleMesh mesh = in_place ? std::move(world.shapes.at(0)) : posed_mesh(world);
        mesh.groups.clear();  // numbers of the bodies
        mesh.warnings = std::move(world.warnings);
        const auto is_finite = [](const auto& xyz) {
            return std::all_of(xyz.begin(), xyz.end(), [](auto x) { return std::isfinite(x); });
        };
        if (!std::visit(is_finite, mesh.vertices))
            throw Error(ErrorCode::format, source.name() + ": a transform takes a vertex beyond all numbers");
        if (options.weld == Weld::yes) weld(mesh);
        return mesh;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its mesh does not fit in memory");
    }
}

TriangleMesh read_one(const Source& source, const ReadOptions& options) {
    check_not_empty(source);
    return is_3mf(source, extension_of(source.name())) ? read_posed(source, options) : read(source, options);
}

WorldMesh read_world(const Source& source, std::optional<std::filesystem::path> folder, const ReadOptions& options) {
    check_not_empty(source);
    const std::string extension = extension_of(source.name());
    if (is_3mf(source, extension)) return read_3mf(source, options);
    if (is_gltf(source, extension)) {
        return read_scene(source, options,
                          [&](Warnings& warnings) { return read_gltf(source, std::move(folder), options, warnings); });
    }
    WorldMesh world;
    world.shapes.push_back(read(source, options));
    world.warnings = std::move(world.shapes[0].warnings);
    world.bodies.push_back({without_gzip_name(source.name()).stem().string()});
    return world;
}

}  // namespace

WorldMesh read_world(const std::filesystem::path& path, const ReadOptions& options) {
    return read_world(Source(path), path.parent_path(), options);
}

WorldMesh read_world(std::istream& in, const std::string& name, const ReadOptions& options) {
    return read_world(Source(in, name), std::nullopt, options);
}

TriangleMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    return read_one(Source(path), options);
}

TriangleMesh read_mesh(std::istream& in, const std::string& name, const ReadOptions& options) {
    return read_one(Source(in, name), options);
}

}  // namespace crumple::io
