// OBJ: statements, one a line. `v` and `f` make the mesh; the other statements of the format are known and skipped,
// except free-form surfaces, which would leave a part of the scene out. An unknown statement is an error.

#include <algorithm>

#include "io/fan.h"
#include "io/formats.h"
#include "io/sink.h"
#include "io/text.h"

namespace crumple::io {

namespace {

constexpr std::string_view skipped[] = {
    "vt",     "vn",     "vp",     "l",          "p",         "o",    "g",     "s",        "mg",       "usemtl",
    "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj", "lod",  "bevel", "c_interp", "d_interp", "ctech",
    "stech",  "cstype", "deg",    "bmat",       "step",      "curv", "curv2", "parm",     "sp",       "end",
};

bool is_skipped(std::string_view word) {
    return std::find(std::begin(skipped), std::end(skipped), word) != std::end(skipped);
}

template <class Scalar>
class ObjReader {
   public:
    explicit ObjReader(const Source& source)
        : in_(source, {.lines = true, .comments = true, .continuation = true}), furthest_place_(source.begin()) {}

    TriangleMesh read() {
        for (; in_.next_line_with_items(); in_.skip_line()) {
            const char* const place = in_.position();
            const std::string_view statement = in_.word();
            if (statement == "v") {
                // What follows is a weight, which polygons ignore, or a colour.
                for (int axis = 0; axis < 3; ++axis) xyz_.push_back(in_.real<Scalar>());
            } else if (statement == "f" || statement == "fo") {
                read_face(place);
            } else if (!is_skipped(statement)) {
                in_.fail(place, "unknown statement " + in_quotes(statement));
            }
        }
        if (furthest_ >= vertex_count()) fail_range(furthest_place_, furthest_ + 1);
        return {std::move(xyz_), std::move(triangles_), {}};
    }

   private:
    std::int64_t vertex_count() const { return static_cast<std::int64_t>(xyz_.size() / 3); }

    void read_face(const char* place) {
        Fan fan(triangles_);
        while (!in_.finished()) fan.add(read_corner());
        if (fan.corners() < 3) in_.fail(place, "a face has " + std::to_string(fan.corners()) + " corners");
    }

    /// v, v/vt, v//vn or v/vt/vn. Negative indices count back from the last vertex so far.
    std::int32_t read_corner() {
        const char* const place = in_.position();
        const std::int64_t written = in_.leading_integer("a vertex index");
        for (const char c : in_.rest_of_word()) {
            if (c != '/' && c != '-' && (c < '0' || c > '9')) in_.fail(place, "a face's corner is not v/vt/vn");
        }
        if (const std::string_view rest = in_.rest_of_word(); !rest.empty()) {
            if (rest[0] != '/') in_.fail(place, "a face's corner is not v/vt/vn");
            in_.word();
        }
        const std::int64_t index = written > 0 ? written - 1 : vertex_count() + written;
        if (written == 0 || index < 0 || index > INT32_MAX) fail_range(place, written);
        if (index > furthest_) {  // the vertex may still come
            furthest_ = index;
            furthest_place_ = place;
        }
        return static_cast<std::int32_t>(index);
    }

    [[noreturn]] void fail_range(const char* place, std::int64_t written) const {
        in_.fail(place, "a face names vertex " + std::to_string(written) + " of " + std::to_string(vertex_count()));
    }

    Scanner in_;
    std::vector<Scalar> xyz_;
    std::vector<std::int32_t> triangles_;
    std::int64_t furthest_ = -1;
    const char* furthest_place_;
};

void write_vertices(Sink& sink, const TriangleMesh& mesh) {
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t i = 0; i < xyz.size(); i += 3) {
                sink << "v " << xyz[i] << ' ' << xyz[i + 1] << ' ' << xyz[i + 2] << '\n';
            }
        },
        mesh.vertices);
}

void write_face(Sink& sink, const std::int32_t* corner) {
    sink << "f " << std::int64_t{corner[0]} + 1 << ' ' << std::int64_t{corner[1]} + 1 << ' '
         << std::int64_t{corner[2]} + 1 << '\n';
}

void write_material(Sink& sink, const char* name, const Colour& colour) {
    sink << "newmtl " << name << "\nKd " << colour.red / 255.0f << ' ' << colour.green / 255.0f << ' '
         << colour.blue / 255.0f << '\n';
}

}  // namespace

bool starts_obj(std::string_view word) {
    // Not the whole list: `p` and `s` might be what is left of "ply" and "solid".
    for (const std::string_view usual : {"v", "vn", "vt", "f", "o", "g", "mtllib", "usemtl"}) {
        if (word == usual) return true;
    }
    return false;
}

TriangleMesh read_obj(const Source& source, const ReadOptions& options) {
    return in_precision(options.precision, ScalarType::float64,
                        [&](auto zero) { return ObjReader<decltype(zero)>(source).read(); });
}

void write_obj(std::ostream& out, const TriangleMesh& mesh) {
    Sink sink(out);
    write_vertices(sink, mesh);
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) write_face(sink, &mesh.triangles[i]);
}

void write_coloured_obj(std::ostream& out, const ColouredMesh& coloured, const std::string& material_file) {
    Sink sink(out);
    sink << "mtllib " << material_file << '\n';
    write_vertices(sink, coloured.mesh);
    int material = -1;  // triangles keep their order, so that ids stay what they are
    for (std::size_t t = 0; t < coloured.hit.size(); ++t) {
        const int wanted = coloured.hit[t] != 0;
        if (wanted != material) sink << (wanted ? "usemtl colliding\n" : "usemtl free\n");
        material = wanted;
        write_face(sink, &coloured.mesh.triangles[3 * t]);
    }
}

void write_materials(std::ostream& out) {
    Sink sink(out);
    write_material(sink, "free", free_colour);
    write_material(sink, "colliding", colliding_colour);
}

}  // namespace crumple::io
