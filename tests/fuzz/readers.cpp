// Fuzz target: the readers of meshes, pair lists, worlds, poses and lists of features. The first byte of an input
// chooses the kind of file, the second one the options; the file follows. Broken promises besides what the sanitizers
// find: an exception other than crumple::Error, an error whose message is not a short printable line with the place in
// the file, an invalid mesh, memory out of proportion to the file, and a mesh that changes when it is written and read
// again.

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "crumple/error.h"
#include "fuzz/archive.h"
#include "fuzz/bodies.h"
#include "fuzz/containers.h"
#include "fuzz/fail.h"
#include "fuzz/feature_rows.h"
#include "fuzz/file.h"
#include "fuzz/memory.h"
#include "fuzz/polygons.h"
#include "fuzz/written.h"
#include "io/bytes/bytes.h"

namespace crumple::fuzz {
namespace {

enum class Content { mesh, pairs, world, poses, features };
enum class Mended { nothing, stl_count, archive, glb, array_of_poses, archive_of_faces, package, gzip };

struct Kind {
    const char* name;  ///< file name; readers take its extension as a hint
    Content content;
    Mended mended = Mended::nothing;  ///< part that is made valid after mutation, so that readers do not stop there
};

constexpr Kind kinds[] = {
    {"file", Content::mesh},
    {"file.ply", Content::mesh},
    {"file.obj", Content::mesh},
    {"file.stl", Content::mesh},
    {"file.off", Content::mesh},
    {"file.stl", Content::mesh, Mended::stl_count},
    {"file.txt", Content::pairs},
    {"file.csv", Content::pairs},
    {"file.json", Content::pairs},
    {"file.npz", Content::pairs},
    {"file.npz", Content::pairs, Mended::archive},
    {"file.npy", Content::pairs},
    {"file.gltf", Content::world},
    {"file.glb", Content::world},
    {"file.glb", Content::world, Mended::glb},
    {"file", Content::world},
    {"file.csv", Content::poses},
    {"file.npy", Content::poses},
    {"file.npy", Content::poses, Mended::array_of_poses},
    {"file.txt", Content::features},
    {"file.csv", Content::features},
    {"file.json", Content::features},
    {"file.npz", Content::features},
    {"file.npz", Content::features, Mended::archive_of_faces},
    {"file.3mf", Content::world},
    {"file.3mf", Content::world, Mended::package},
    {"file.3mf", Content::mesh, Mended::package},
    {"file.obj.gz", Content::mesh},
    {"file.obj.gz", Content::mesh, Mended::gzip},
    {"file.csv.gz", Content::pairs, Mended::gzip},
};

std::string mend(std::string_view bytes, Mended mended) {
    if (mended == Mended::archive) return archive_of({{"pairs.npy", bytes}});
    if (mended == Mended::archive_of_faces) return archive_of({{"face_faces.npy", bytes}});
    if (mended == Mended::package) return package_of(bytes);
    if (mended == Mended::gzip) return gzip_of(bytes);
    if (mended == Mended::glb) return glb_of(bytes);
    if (mended == Mended::array_of_poses) return npy_of_poses(bytes);
    std::string file(bytes);
    constexpr std::size_t header = 80, prologue = 84, record = 50;
    if (mended == Mended::stl_count && file.size() >= prologue) {
        const auto count = io::little_endian(static_cast<std::uint32_t>((file.size() - prologue) / record));
        std::copy(count.begin(), count.end(), file.begin() + header);
        file.resize(prologue + (file.size() - prologue) / record * record);
    }
    return file;
}

io::ReadOptions options_of(std::uint8_t byte) {
    constexpr io::Precision precisions[] = {io::Precision::automatic, io::Precision::automatic, io::Precision::float32,
                                            io::Precision::float64};
    constexpr io::Weld welds[] = {io::Weld::automatic, io::Weld::no, io::Weld::yes, io::Weld::automatic};
    constexpr const char* groups[] = {"", "", "group", "label"};
    io::ReadOptions options;
    options.precision = precisions[byte & 3];
    options.weld = welds[byte >> 2 & 3];
    options.group_property = groups[byte >> 4 & 3];
    options.triangulation = byte & 64 ? io::Triangulation::fan : io::Triangulation::ears;
    options.strict = byte & 128;
    if ((byte & 0x30) == 0x10) options.unit = io::Unit::inch;  // only if no group property is chosen
    return options;
}

bool is_compressed(const Kind& kind) {
    const std::string_view name = kind.name;
    return name.ends_with(".npz") || name.ends_with(".3mf") || name.ends_with(".gz");
}

/// True for a zip archive or, below, a glTF scene. Readers recognise these by content, whatever the name.
bool is_archive(std::string_view file) { return file.starts_with("PK"); }
bool is_scene(std::string_view file) {
    if (file.starts_with("\xef\xbb\xbf")) file.remove_prefix(3);
    const std::size_t first = file.find_first_not_of(" \t\r\n");
    return file.starts_with("glTF") || (first != file.npos && file[first] == '{');
}

bool is_short_and_printable(std::string_view sentence) {
    return sentence.size() < 512 &&
           std::all_of(sentence.begin(), sentence.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

void check_error(const Error& error, std::string_view file, const Kind& kind, bool names_property) {
    const std::string_view message = error.what();
    const auto check = [&](bool holds, const char* what) {
        if (!holds) fail(std::string(what) + ": " + error.what());
    };
    check(error.code == ErrorCode::format || (names_property && error.code == ErrorCode::invalid_argument),
          "an error of a wrong kind");
    check(message.find(kind.name) != message.npos, "an error that does not name the file");
    check(is_short_and_printable(message), "an error that is no short line");
    const auto size = static_cast<std::int64_t>(file.size());
    const bool line = error.element == Element::line, byte = error.element == Element::byte;
    if (line) {
        const auto ends = std::count_if(file.begin(), file.end(), [](char c) { return c == '\n' || c == '\r'; });
        check(error.index >= 1 && (is_compressed(kind) || error.index <= ends + 1), "an error at no line of the file");
    }
    if (byte) check(error.index >= 0 && error.index <= size, "an error at no byte of the file");
    if (line || byte)
        check(message.find((line ? "line " : "byte ") + std::to_string(error.index)) != message.npos ||
                  (byte && error.index == 0),
              "an error that does not tell its place");
}

/// Returns the result of read(), or nothing if it throws an allowed error; checks the error and the peak memory.
template <class Read>
auto watched(std::string_view file, const Kind& kind, bool names_property, Read&& read) {
    std::optional<decltype(read())> result;
    std::int64_t peak = 0;
    try {
        const MemoryWatch watch;
        try {
            result = read();
        } catch (const Error& error) {
            check_error(error, file, kind, names_property);
        }
        peak = watch.peak();
    } catch (const std::exception& other) {
        fail(std::string("an exception that is not crumple::Error: ") + other.what());
    }
    // Limits of the peak memory. A corner takes as little as one byte in the file, but a triangle 12 bytes in a vector
    // whose capacity doubles, and ear clipping needs lists. Deflated bytes expand up to a thousandfold. A few lines of
    // 3MF can create 65,536 bodies. In glTF, eight triangles may refer to the same byte of the binary chunk.
    const bool package = std::strcmp(kind.name, "file.3mf") == 0 || is_archive(file);
    const bool scene = kind.content == Content::world || is_scene(file);
    const auto size = static_cast<std::int64_t>(file.size());
    const std::int64_t most = package               ? (256 << 20) + 4096 * size
                              : is_compressed(kind) ? (4 << 20) + 4096 * size
                              : scene               ? (64 << 10) + 1024 * size
                                                    : (64 << 10) + 128 * size;
    if (peak > most) fail(std::to_string(peak) + " bytes held to read " + std::to_string(size));
    return result;
}

void check_warnings(const std::vector<std::string>& warnings, const Kind& kind, const io::ReadOptions& options) {
    require(!options.strict || warnings.empty(), "a warning to those who want errors");
    require(warnings.size() <= 64, "more warnings than anybody reads");
    for (const std::string& warning : warnings) {
        require(is_short_and_printable(warning), "a warning that is no short line");
        require(warning.find(kind.name) != warning.npos, "a warning that does not name the file");
    }
}

void check_precision(const io::TriangleMesh& mesh, const io::ReadOptions& options) {
    if (options.precision != io::Precision::automatic)
        require((mesh.precision() == ScalarType::float32) == (options.precision == io::Precision::float32),
                "another precision than asked for");
}

void check_mesh(std::string_view file, const Kind& kind, const io::ReadOptions& options) {
    const bool names_property = !options.group_property.empty();
    const auto mesh = watched(file, kind, names_property, [&] { return read_mesh(file, kind.name, options); });
    if (!mesh) return;
    require_sound(*mesh);
    require_cut(*mesh, options.triangulation);
    check_warnings(mesh->warnings, kind, options);
    require(mesh->groups.empty() || names_property, "groups that nobody asked for");
    require(!names_property || mesh->groups.size() == mesh->triangles.size() / 3, "groups are missing");
    check_precision(*mesh, options);
    // `automatic` welds the shapes of a scene separately.
    const bool by_shape = options.weld == io::Weld::automatic && (is_scene(file) || is_archive(file));
    if (options.weld != io::Weld::no && !by_shape) {
        io::ReadOptions unwelded = options;
        unwelded.weld = io::Weld::no;
        const io::TriangleMesh before = read_mesh(file, kind.name, unwelded);
        if (options.weld == io::Weld::yes || before.vertex_count() != mesh->vertex_count())
            require_welded(*mesh, before);
        else
            require_same(*mesh, before, "read again");
    }
    require_kept_by_writers(*mesh, options.triangulation);
}

void check_pairs(std::string_view file, const Kind& kind) {
    const auto pairs = watched(file, kind, false, [&] { return read_pairs(file, kind.name); });
    if (!pairs) return;
    for (const Pair& pair : *pairs) require(pair.a >= 0 && pair.b >= 0, "a pair names no triangle");
    require_kept_by_writers(*pairs);
}

void check_world(std::string_view file, const Kind& kind, io::ReadOptions options) {
    options.group_property.clear();  // glTF has no such properties
    const auto world = watched(file, kind, false, [&] { return read_world(file, kind.name, options); });
    if (!world) return;
    require_sound(*world);
    check_warnings(world->warnings, kind, options);
    for (const io::TriangleMesh& shape : world->shapes) check_precision(shape, options);
    if (options.weld == io::Weld::yes) {
        io::ReadOptions unwelded = options;
        unwelded.weld = io::Weld::no;
        require_welded(*world, read_world(file, kind.name, unwelded));
    }
    require_kept_by_writer(*world);
}

void check_poses(std::string_view file, const Kind& kind, std::uint8_t byte) {
    const std::vector<std::string> all{"base", "arm", "hand"}, bodies(all.begin(), all.begin() + byte % 4);
    const auto poses = watched(file, kind, false, [&] { return read_poses(file, kind.name, bodies); });
    if (poses) require_kept(*poses, bodies);
}

/// Reads the file as a list of candidates, impacts or near pairs, which `byte` chooses, and checks its rows.
void check_features(std::string_view file, const Kind& kind, std::uint8_t byte) {
    if (byte % 3 == 0) {
        const auto rows = watched(file, kind, false, [&] { return read_candidates(file, kind.name); });
        if (rows) require_kept(*rows);
        return;
    }
    const bool impacts = byte % 3 == 1;
    const auto rows = watched(file, kind, false,
                              [&] { return impacts ? read_impacts(file, kind.name) : read_near(file, kind.name); });
    if (rows) require_kept(*rows, impacts);
}

}  // namespace
}  // namespace crumple::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace crumple;
    using namespace crumple::fuzz;
    if (size < 2) return -1;
    const Kind& kind = kinds[data[0] % std::size(kinds)];
    const std::string file = mend({reinterpret_cast<const char*>(data) + 2, size - 2}, kind.mended);
    switch (kind.content) {
        case Content::mesh:
            check_mesh(file, kind, options_of(data[1]));
            break;
        case Content::pairs:
            check_pairs(file, kind);
            break;
        case Content::world:
            check_world(file, kind, options_of(data[1]));
            break;
        case Content::poses:
            check_poses(file, kind, data[1]);
            break;
        case Content::features:
            check_features(file, kind, data[1]);
            break;
    }
    return 0;
}
