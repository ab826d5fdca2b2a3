// Reader and writer of STL: triangles by their coordinates. Binary files have 80 arbitrary bytes, a count, and 50 bytes
// per triangle (normal, three vertices, 16 bits). Text files have `solid`, facets and `endsolid` for each solid. The
// reader skips normals. Both kinds may begin with "solid": a file is binary if its size is exactly the size that its
// count implies, or if one of its first 512 bytes is zero.

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <numeric>

#include "io/bytes/bytes.h"
#include "io/bytes/large_pages.h"
#include "io/bytes/sink.h"
#include "io/bytes/text.h"
#include "io/formats.h"

namespace crumple::io {

namespace {

constexpr std::size_t header_size = 80, prologue_size = 84, record_size = 50, normal_size = 12;

bool equal_ignoring_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::size_t announced_count(const Source& source) {
    return load<std::uint32_t>(source.begin() + header_size, std::endian::little);
}

bool is_text(const Source& source) { return source.text().substr(0, 512).find('\0') == std::string_view::npos; }

/// Throws Error that names the first coordinate from `record` on that is not finite. There must be such a coordinate.
[[noreturn]] void fail_not_finite(const Source& source, const char* record) {
    for (;; record += record_size)
        for (std::size_t i = 0; i < 9; ++i) {
            const char* const place = record + normal_size + 4 * i;
            if (!std::isfinite(load<float>(place, std::endian::little)))
                source.fail_at_byte(place, "a coordinate is not finite");
        }
}

template <class Scalar>
TriangleMesh read_binary(const Source& source) {
    constexpr std::size_t block = 256;  // triangles per block, few enough for the cache
    std::array<Scalar, 9 * block> coordinates;
    std::array<std::int32_t, 3 * block> corners;
    const char* record = source.begin() + prologue_size;
    const std::size_t count = announced_count(source);
    std::vector<Scalar> xyz;
    std::vector<std::int32_t> triangles;
    reserve_large(xyz, 9 * count);
    reserve_large(triangles, 3 * count);
    for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t size = std::min(block, count - begin);
        bool finite = true;
        for (std::size_t t = 0; t < size; ++t) {
            for (std::size_t i = 0; i < 9; ++i) {
                const float value = load<float>(record + record_size * t + normal_size + 4 * i, std::endian::little);
                finite &= std::abs(value) <= std::numeric_limits<float>::max();
                coordinates[9 * t + i] = value;
            }
        }
        if (!finite) fail_not_finite(source, record);
        std::iota(corners.begin(), corners.end(), static_cast<std::int32_t>(3 * begin));
        xyz.insert(xyz.end(), coordinates.data(), coordinates.data() + 9 * size);
        triangles.insert(triangles.end(), corners.data(), corners.data() + 3 * size);
        record += record_size * size;
    }
    return {std::move(xyz), std::move(triangles)};
}

enum class Keyword : std::uint8_t { solid, facet, normal, outer, loop, vertex, endloop, endfacet, endsolid, none };
constexpr std::string_view keywords[] = {"solid",  "facet",   "normal",   "outer",   "loop",
                                         "vertex", "endloop", "endfacet", "endsolid"};

Keyword keyword_named(std::string_view word) {
    const auto* const found = std::find_if(std::begin(keywords), std::end(keywords), [&](std::string_view keyword) {
        return equal_ignoring_case(word, keyword);
    });
    return static_cast<Keyword>(found - std::begin(keywords));
}

/// Reader of STL as text. A keyword may be followed by other words on its line, such as names and colours. "end solid"
/// and so on, with a blank, are accepted as keywords.
template <class Scalar>
class AsciiReader {
   public:
    AsciiReader(const Source& source, Warnings& warnings) : in_(source, {.lines = true}), warnings_(warnings) {}

    TriangleMesh read() {
        expect(Keyword::solid);
        do read_solid();
        while (!at_end_ && next() && expected(Keyword::solid));
        std::vector<std::int32_t> triangles(xyz_.size() / 3);
        std::iota(triangles.begin(), triangles.end(), 0);
        return {std::move(xyz_), std::move(triangles)};
    }

   private:
    /// Reads the rest of a solid, after its first keyword.
    void read_solid() {
        const char* const solid = place_;
        skip_line();  // the solid's name, which may be any text
        if (in_.at_end() && xyz_.empty()) in_.fail(solid, "no line follows this one, which holds the solid's name");
        while (next()) {
            if (keyword_ == Keyword::endsolid) return skip_line();  // skips the name, which is repeated here
            if (keyword_ != Keyword::facet) fail("facet or endsolid");
            read_facet();
        }
        warnings_.at_line(in_.position(), "endsolid is missing: the file may have lost its end");
        at_end_ = true;
    }

    void read_facet() {
        expect(Keyword::normal);
        for (int axis = 0; axis < 3; ++axis) in_.word("a normal");
        expect(Keyword::outer);
        expect(Keyword::loop);
        std::int64_t corners = 0;
        while (require_next("endloop"), keyword_ != Keyword::endloop) {
            if (keyword_ != Keyword::vertex) fail("vertex or endloop");
            for (int axis = 0; axis < 3; ++axis) {
                in_.next_line_with_items();
                xyz_.push_back(in_.real<Scalar>());
            }
            ++corners;
        }
        if (corners != 3) in_.fail(place_, "a facet has " + std::to_string(corners) + " corners instead of 3");
        expect(Keyword::endfacet);
    }

    /// Moves to the next keyword, or to another word that begins a line. Returns false at the end of the file.
    bool next() {
        while (true) {
            same_line_ = same_line_ && !in_.finished();
            if (!in_.next_line_with_items()) return false;
            place_ = in_.position();
            word_ = in_.word();
            if (equal_ignoring_case(word_, "end") && !in_.finished())
                keyword_ = keyword_named("end" + std::string(in_.word()));
            else
                keyword_ = keyword_named(word_);
            const bool is_keyword = keyword_ != Keyword::none;
            if (!is_keyword && equal_ignoring_case(word_, "color")) {
                skip_line();
            } else if (is_keyword || !same_line_) {
                same_line_ = true;
                return true;
            }
        }
    }
    void skip_line() {
        in_.skip_line();
        same_line_ = false;
    }
    void require_next(const std::string& what) {
        if (!next()) in_.fail(what + " is missing");
    }
    void expect(Keyword keyword) {
        require_next(std::string(keywords[static_cast<std::size_t>(keyword)]));
        expected(keyword);
    }
    bool expected(Keyword keyword) const {
        if (keyword_ != keyword) fail(std::string(keywords[static_cast<std::size_t>(keyword)]));
        return true;
    }
    [[noreturn]] void fail(const std::string& wanted) const {
        in_.fail(place_, wanted + " is expected, not " + in_quotes(word_));
    }

    Scanner in_;
    Warnings& warnings_;
    std::vector<Scalar> xyz_;
    const char* place_ = nullptr;  ///< place of `word_`
    std::string_view word_;        ///< the last keyword as written, or another word that begins a line
    Keyword keyword_ = Keyword::none;
    bool same_line_ = false;  ///< true while the scanner is in the line of `word_`
    bool at_end_ = false;
};

/// Returns the unit normal, or zero if the cross product of two edges, computed in float64, is zero. float32
/// coordinates neither overflow nor underflow here.
std::array<float, 3> normal_of(const std::array<std::array<float, 3>, 3>& corners) {
    std::array<double, 3> u, v;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        u[axis] = double{corners[1][axis]} - double{corners[0][axis]};
        v[axis] = double{corners[2][axis]} - double{corners[0][axis]};
    }
    const std::array<double, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return {};
    return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length)};
}

}  // namespace

bool is_binary_stl(const Source& source) {
    const std::size_t size = source.text().size();
    return size >= prologue_size && size == prologue_size + record_size * announced_count(source);
}

TriangleMesh read_stl(const Source& source, const ReadOptions& options, Warnings& warnings) {
    const std::size_t size = source.text().size();
    if (!is_binary_stl(source) && is_text(source)) {
        return in_precision(options.precision, ScalarType::float64,
                            [&](auto zero) { return AsciiReader<decltype(zero)>(source, warnings).read(); });
    }
    const char* const place = source.begin() + std::min(header_size, size);
    const std::size_t end = size < prologue_size ? SIZE_MAX : prologue_size + record_size * announced_count(source);
    if (end > size) source.fail_at_byte(place, "the file is too short for the triangles announced here");
    constexpr std::size_t most = INT32_MAX / 3;  // each triangle has three vertices, and vertex ids are int32
    if (announced_count(source) > most)
        source.fail_at_byte(place, "the file announces more than " + std::to_string(most) + " triangles");
    if (end < size) {
        warnings.at_byte(source.begin() + end,
                         std::to_string(size - end) + " bytes after the triangles that the file announces are skipped");
    }
    return in_precision(options.precision, ScalarType::float32,
                        [&](auto zero) { return read_binary<decltype(zero)>(source); });
}

void write_stl(std::ostream& out, const TriangleMesh& mesh, bool) {
    Sink sink(out);
    constexpr std::string_view title = "binary STL, written by Crumple";  // must not begin with "solid"
    sink << title;
    for (std::size_t i = title.size(); i < header_size; ++i) sink << ' ';
    sink.little(static_cast<std::uint32_t>(mesh.triangle_count()));
    for (std::size_t t = 0; t < mesh.triangles.size() / 3; ++t) {
        std::array<std::array<float, 3>, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto vertex = static_cast<std::size_t>(mesh.triangles[3 * t + c]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                corners[c][axis] = std::visit(
                    [&](const auto& xyz) { return static_cast<float>(xyz[3 * vertex + axis]); }, mesh.vertices);
                if (!std::isfinite(corners[c][axis])) {
                    throw Error(ErrorCode::invalid_argument,
                                "vertex " + std::to_string(vertex) + " overflows float32, which .stl holds",
                                Element::vertex, static_cast<std::int64_t>(vertex));
                }
            }
        }
        for (const auto& row : {normal_of(corners), corners[0], corners[1], corners[2]}) {
            sink.little(row[0], row[1], row[2]);
        }
        sink.little(std::uint16_t{0});
    }
}

}  // namespace crumple::io
