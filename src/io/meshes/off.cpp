// Reader and writer of OFF: counts, then one vertex per line, then faces. Prefixes in the header (ST, C, N) announce
// data that follow the coordinates of a vertex on its line. The reader skips these data, and colours after the last
// corner of a face on the same line.

#include <algorithm>

#include "io/bytes/sink.h"
#include "io/bytes/text.h"
#include "io/formats.h"
#include "io/meshes/faces.h"

namespace crumple::io {

namespace {

template <class Scalar>
class OffReader {
   public:
    explicit OffReader(const Source& source) : in_(source, {.lines = true, .comments = true}) {}

    TriangleMesh read(const ReadOptions& options, Warnings& warnings) {
        read_header();
        const std::int64_t vertices = read_count("vertices", 6);  // at least 6 bytes each: "0 0 0" and a line end
        const std::int64_t faces = read_count("faces", 2);        // at least 2 bytes each: "0" and a line end
        if (!in_.finished()) in_.integer("a count of edges");     // never used, often wrong or missing
        if (!in_.finished()) in_.fail("the line of counts has more than three numbers");
        in_.skip_line();

        std::vector<Scalar> xyz;
        xyz.reserve(3 * static_cast<std::size_t>(vertices));
        for (std::int64_t v = 0; v < vertices; ++v) {
            next_item("a vertex");
            for (int axis = 0; axis < 3; ++axis) xyz.push_back(in_.real<Scalar>());
            in_.skip_line();
        }
        faces_.reserve(
            std::min(faces, static_cast<std::int64_t>(in_.remaining()) / 8));  // "3 0 1 2" and a line end: 8 bytes
        for (std::int64_t f = 0; f < faces; ++f) {
            read_face(vertices);
            in_.skip_line();
        }
        if (in_.next_line_with_items()) in_.fail("data follows the last face that the header announces");
        return faces_.mesh(std::move(xyz), options.triangulation, warnings, true);
    }

   private:
    /// Moves to the next word, in this line or a later one. Throws Error, which names `what`, at the end of the file.
    void next_item(const char* what) {
        if (!in_.next_line_with_items()) in_.fail(std::string(what) + " is missing");
    }

    void read_header() {
        next_item("the header");
        const std::string_view word = in_.rest_of_word();
        const std::size_t keyword = off_keyword(word);
        if (!keyword && word[0] >= '0' && word[0] <= '9') return;  // the keyword is optional
        if (!keyword) in_.fail("OFF is expected, not " + in_quotes(word));
        if (word.substr(0, keyword).find_first_of("4n") != word.npos)
            in_.fail("only OFF in three dimensions is supported");
        in_.skip_characters(keyword);
        if (!in_.finished() && *in_.position() == 'B') in_.fail("binary OFF is not supported");
        next_item("a count of vertices");
    }

    std::int64_t read_count(const char* what, std::int64_t least_size) {
        const char* const place = in_.position();
        const std::int64_t count = in_.integer(what);
        if (count < 0 || count > (static_cast<std::int64_t>(in_.remaining()) + 1) / least_size) {
            in_.fail(place, std::to_string(count) + ' ' + what + " do not fit in the rest of the file");
        }
        return count;
    }

    void read_face(std::int64_t vertices) {
        next_item("a face");
        const char* const place = in_.position();
        const std::int64_t corners = in_.integer("a count of corners");
        if (corners < 0) in_.fail(place, "a face has " + std::to_string(corners) + " corners");
        faces_.begin(place);
        for (std::int64_t i = 0; i < corners; ++i) {
            next_item("a corner");
            const std::int64_t index = in_.integer("a corner");
            if (index < 0 || index >= vertices) {
                in_.fail(place, "a face names vertex " + std::to_string(index) + " of " + std::to_string(vertices));
            }
            faces_.add(static_cast<std::int32_t>(index));
        }
        faces_.end();
    }

    Scanner in_;
    Faces faces_;
};

}  // namespace

std::size_t off_keyword(std::string_view word) {
    const std::size_t off = word.find("OFF");
    if (off == word.npos || word.find_first_not_of("0123456789", off + 3) != word.npos) return 0;
    for (std::string_view prefixes = word.substr(0, off); !prefixes.empty();) {
        const bool texture = prefixes.starts_with("ST");
        if (!texture && std::string_view("CN4n").find(prefixes[0]) == word.npos) return 0;
        prefixes.remove_prefix(texture ? 2 : 1);
    }
    return off + 3;
}

TriangleMesh read_off(const Source& source, const ReadOptions& options, Warnings& warnings) {
    return in_precision(options.precision, ScalarType::float64,
                        [&](auto zero) { return OffReader<decltype(zero)>(source).read(options, warnings); });
}

void write_off(std::ostream& out, const TriangleMesh& mesh, bool polygons) {
    Sink sink(out);
    sink << "OFF\n"
         << mesh.vertex_count() << ' ' << (polygons ? mesh.polygons.count() : mesh.triangle_count()) << " 0\n";
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t i = 0; i < xyz.size(); i += 3) {
                sink << double{xyz[i]} << ' ' << double{xyz[i + 1]} << ' ' << double{xyz[i + 2]} << '\n';
            }
        },
        mesh.vertices);
    for_each_face(mesh, polygons, [&](auto corners, std::size_t) {
        sink << std::int64_t(corners.size());
        for (const std::int32_t corner : corners) sink << ' ' << corner;
        sink << '\n';
    });
}

}  // namespace crumple::io
