// Reader and writer of OBJ: one statement per line. The statements `v` and `f` define the mesh, `l` and `p` its lines
// and points, which are read if requested. Other statements of the format are skipped, except those of free-form
// surfaces: these are errors, because a part of the scene would be missing. Statements that exporters have added to the
// format are skipped with a warning.

#include <algorithm>
#include <cctype>
#include <span>

#include "io/bytes/sink.h"
#include "io/bytes/text.h"
#include "io/formats.h"
#include "io/meshes/faces.h"

namespace crumple::io {

namespace {

constexpr std::string_view skipped[] = {
    "vt",     "vn",     "vp",     "l",          "p",         "o",    "g",     "s",        "mg",       "usemtl",
    "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj", "lod",  "bevel", "c_interp", "d_interp", "ctech",
    "stech",  "cstype", "deg",    "bmat",       "step",      "curv", "curv2", "parm",     "sp",       "end",
};

constexpr std::string_view surfaces[] = {"surf", "trim", "hole", "scrv", "con", "bsp", "bzp", "cdc", "cdp", "res"};

bool is_one_of(std::span<const std::string_view> words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// True if a statement could have this name in an extension of the format by an exporter. Any other word at the start
/// of a line means that the file is damaged.
bool is_identifier(std::string_view word) {
    return !std::isdigit(static_cast<unsigned char>(word[0])) &&
           std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

template <class Scalar>
class ObjReader {
   public:
    ObjReader(const Source& source, const ReadOptions& options, Warnings& warnings)
        : in_(source, {.lines = true, .comments = true, .continuation = true}),
          options_(options),
          warnings_(warnings),
          furthest_place_(source.begin()) {}

    TriangleMesh read() {
        WarningTally unknown;
        std::string first_unknown;
        for (; in_.next_line_with_items(); in_.skip_line()) {
            const char* const place = in_.position();
            const std::string_view statement = in_.word();
            if (statement == "v") {
                read_vertex(place);
            } else if (statement == "f" || statement == "fo") {
                read_face(place);
            } else if (options_.lines_and_points && statement == "l") {
                read_line(place);
            } else if (options_.lines_and_points && statement == "p") {
                read_points(place);
            } else if (is_one_of(surfaces, statement)) {
                in_.fail(place,
                         in_quotes(statement) + ": free-form surfaces are not supported; convert them to polygons");
            } else if (!is_one_of(skipped, statement)) {
                if (!is_identifier(statement)) in_.fail(place, in_quotes(statement) + " is not a statement");
                unknown.add(place);
                if (unknown.count == 1) first_unknown = in_quotes(statement);
            }
        }
        if (furthest_ >= vertex_count()) fail_range(furthest_what_, furthest_place_, furthest_ + 1);
        if (unknown.count > 0) {
            if (xyz_.empty()) in_.fail(unknown.first, first_unknown + " is not a statement of an OBJ file");
            warnings_.at_line(unknown.first,
                              "the unknown statement " + first_unknown + " is skipped" + unknown.others());
        }
        TriangleMesh mesh = faces_.mesh(std::move(xyz_), options_.triangulation, warnings_, true);
        mesh.lines = std::move(lines_);
        mesh.points = std::move(points_);
        return mesh;
    }

   private:
    std::int64_t vertex_count() const { return static_cast<std::int64_t>(xyz_.size() / 3); }

    /// Reads a vertex. Its coordinates may be followed by a weight, which polygons ignore, by a colour, or by a colour
    /// and a weight or opacity; all these are skipped.
    void read_vertex(const char* place) {
        for (int axis = 0; axis < 3; ++axis) xyz_.push_back(in_.real<Scalar>());
        int more = 0;
        for (; !in_.finished(); ++more) in_.template real<double>();
        if (more == 2 || more > 4) {
            in_.fail(place, "a vertex has " + std::to_string(3 + more) +
                                " numbers: a weight (1), a colour (3) or both may follow its coordinates");
        }
    }

    void read_face(const char* place) {
        faces_.begin(place);
        while (!in_.finished()) faces_.add(read_corner("face"));
        faces_.end();
    }

    void read_line(const char* place) {
        std::int32_t last = -1;
        std::size_t vertices = 0;
        for (; !in_.finished(); ++vertices) {
            const char* const at = in_.position();
            const std::int32_t next = read_corner("line");
            if (vertices > 0 && next == last) in_.fail(at, "a line names a vertex twice in succession");
            if (vertices > 0) lines_.push_back({last, next});
            last = next;
        }
        if (vertices < 2) in_.fail(place, "a line has fewer than two vertices");
    }

    void read_points(const char* place) {
        if (in_.finished()) in_.fail(place, "a point names no vertex");
        while (!in_.finished()) points_.push_back(read_corner("point"));
    }

    /// Reads a corner: v, v/vt, v//vn or v/vt/vn, where vt and vn may be missing after their slash, as some exporters
    /// write it. Negative indices count back from the last vertex so far. `what` names the statement in messages.
    std::int32_t read_corner(const char* what) {
        const char* const place = in_.position();
        const std::int64_t written = in_.leading_integer("a vertex index");
        if (const std::string_view rest = in_.rest_of_word(); !rest.empty()) {
            if (!are_further_indices(rest))
                in_.fail(place, std::string("a ") + what + "'s corner must be v, v/vt, v//vn or v/vt/vn");
            in_.word();
        }
        const std::int64_t index = written > 0 ? written - 1 : vertex_count() + written;
        if (written == 0 || index < 0 || index > INT32_MAX) fail_range(what, place, written);
        if (index > furthest_) {  // the vertex may follow later in the file
            furthest_ = index;
            furthest_place_ = place;
            furthest_what_ = what;
        }
        return static_cast<std::int32_t>(index);
    }

    /// True if the text consists of at most two slashes, each followed by an integer or nothing. The range of the
    /// integers is not checked.
    static bool are_further_indices(std::string_view text) {
        for (int slashes = 0; slashes < 2 && text.starts_with('/'); ++slashes) {
            text.remove_prefix(1);
            const bool negative = text.starts_with('-');
            const std::size_t digits = std::min(text.find_first_not_of("0123456789", negative), text.size());
            if (negative && digits == 1) return false;
            text.remove_prefix(digits);
        }
        return text.empty();
    }

    [[noreturn]] void fail_range(const char* what, const char* place, std::int64_t written) const {
        in_.fail(place, std::string("a ") + what + " names vertex " + std::to_string(written) + " of " +
                            std::to_string(vertex_count()));
    }

    Scanner in_;
    const ReadOptions& options_;
    Warnings& warnings_;
    std::vector<Scalar> xyz_;
    Faces faces_;
    std::int64_t furthest_ = -1;
    const char* furthest_place_;
    const char* furthest_what_ = "face";
    std::vector<Edge> lines_;
    std::vector<std::int32_t> points_;
};

void write_vertices(Sink& sink, const TriangleMesh& mesh) {
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t i = 0; i < xyz.size(); i += 3) {
                sink << "v " << double{xyz[i]} << ' ' << double{xyz[i + 1]} << ' ' << double{xyz[i + 2]} << '\n';
            }
        },
        mesh.vertices);
}

void write_face(Sink& sink, std::span<const std::int32_t> corners) {
    sink << 'f';
    for (const std::int32_t corner : corners) sink << ' ' << std::int64_t{corner} + 1;
    sink << '\n';
}

void write_material(Sink& sink, const Material& material) {
    const auto& [name, colour, opacity] = material;
    sink << "newmtl " << name << "\nKd " << colour.red / 255.0f << ' ' << colour.green / 255.0f << ' '
         << colour.blue / 255.0f << '\n';
    if (opacity < 1) sink << "d " << opacity << '\n';
}

}  // namespace

bool starts_obj(std::string_view word) {
    // Some statements are left out of this list: `p` and `s` might be remains of "ply" and "solid" in a damaged file.
    for (const std::string_view usual : {"v", "vn", "vt", "f", "o", "g", "mtllib", "usemtl"}) {
        if (word == usual) return true;
    }
    return false;
}

TriangleMesh read_obj(const Source& source, const ReadOptions& options, Warnings& warnings) {
    return in_precision(options.precision, ScalarType::float64,
                        [&](auto zero) { return ObjReader<decltype(zero)>(source, options, warnings).read(); });
}

void write_obj(std::ostream& out, const TriangleMesh& mesh, bool polygons) {
    Sink sink(out);
    if (mesh.vertex_count() == 0) sink << "# nothing\n";  // an empty file could not be read back
    write_vertices(sink, mesh);
    for_each_face(mesh, polygons, [&](auto corners, std::size_t) { write_face(sink, corners); });
}

void write_coloured_obj(std::ostream& out, const ColouredMesh& coloured, const std::string& material_file) {
    Sink sink(out);
    sink << "mtllib " << material_file << '\n';
    write_vertices(sink, coloured.mesh);
    int material = -1;  // faces keep their order, so that their ids stay valid
    for_each_face(coloured.mesh, coloured.has_polygons(), [&](auto corners, std::size_t triangle) {
        const int wanted = coloured.hit[triangle];
        if (wanted != material) sink << "usemtl " << coloured.materials[static_cast<std::size_t>(wanted)].name << '\n';
        material = wanted;
        write_face(sink, corners);
    });
}

void write_materials(std::ostream& out, std::span<const Material> materials) {
    Sink sink(out);
    sink << title_of_materials << '\n';
    for (const Material& material : materials) write_material(sink, material);
}

}  // namespace crumple::io
