// Tests of what all formats share: recognition of the format, precision, rounding, welding, files that cannot be read.

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cfenv>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "samples.h"

namespace crumple::io::test {
namespace {

TEST(MeshReading, ply_stl_obj_and_off_give_the_same_mesh) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        expect_same(read_bytes(sample.bytes, sample.name, {.precision = Precision::float64}), sample_mesh());
    }
}

TEST(MeshReading, content_and_not_extension_decides_the_format) {
    for (const Sample& sample : samples()) {
        for (const char* const name : {"mesh.obj", "mesh.ply", "mesh.stl", "mesh.off", "mesh.dat", "mesh"}) {
            SCOPED_TRACE(sample.name + " as " + name);
            const ReadOptions options{.precision = Precision::float64, .weld = Weld::yes};
            expect_same(read_bytes(sample.bytes, name, options), sample_mesh());
        }
    }
}

TEST(MeshReading, windows_line_ends_make_no_difference) {
    for (const Sample& sample : samples()) {
        if (sample.bytes.find('\0') != std::string::npos) continue;
        SCOPED_TRACE(sample.name);
        std::string bytes;
        for (const char c : sample.bytes) bytes += c == '\n' ? "\r\n" : std::string(1, c);
        expect_same(read_bytes(bytes, sample.name), read_bytes(sample.bytes, sample.name));
    }
}

TEST(MeshReading, single_carriage_returns_end_lines) {
    for (const Sample& sample : samples()) {
        if (sample.bytes.find('\0') != std::string::npos) continue;
        SCOPED_TRACE(sample.name);
        std::string bytes = sample.bytes;
        std::replace(bytes.begin(), bytes.end(), '\n', '\r');
        expect_same(read_bytes(bytes, sample.name), read_bytes(sample.bytes, sample.name));
    }
    expect_bad("v 0 0 0\rv 1 0 0\r\nv x 0 0\n", "a.obj", Element::line, 3, "'x'");
}

TEST(MeshReading, body_of_binary_ply_begins_after_any_line_end_of_the_header) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        const std::string bytes = binary_ply(order);
        const std::size_t end = bytes.find("end_header\n") + 11;
        std::string header = bytes.substr(0, end), body = bytes.substr(end);
        for (const char* const line_end : {"\n", "\r", "\r\n"}) {
            std::string changed;
            for (const char c : header) changed += c == '\n' ? line_end : std::string(1, c);
            expect_same(read_bytes(changed + body, "a.ply"), sample_mesh());
        }
    }
    // The header ends with CR, and the body begins with a byte equal to LF, which is data.
    const std::string header =
        "ply\rformat binary_little_endian 1.0\relement tag 1\rproperty uchar a\relement vertex 0\r"
        "property float x\rproperty float y\rproperty float z\relement face 0\r"
        "property list uchar int vertex_indices\rend_header\r";
    EXPECT_EQ(read_bytes(header + "\n", "a.ply").vertex_count(), 0);
}

TEST(MeshReading, stream_is_read_like_a_file) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        std::istringstream in(sample.bytes);
        expect_same(read_mesh(in, "-"), read_bytes(sample.bytes, sample.name));
        std::istringstream cut(sample.bytes.substr(0, 7));
        EXPECT_NE(std::string(error_of([&] { read_mesh(cut, "standard input"); }).what()).find("standard input"),
                  std::string::npos);
    }
}

TEST(MeshReading, empty_file_is_an_error_and_file_without_triangles_a_warning) {
    for (const char* const name : {"a.obj", "a.ply", "a.stl", "a.off", "a.dat"}) {
        for (const char* const bytes : {"", "\n \r\n"}) expect_bad(bytes, name, Element::byte, 0, "the file is empty");
    }
    for (const Sample& sample : std::vector<Sample>{{"a.obj", "# nothing\n"},
                                                    {"a.obj", "v 0 0 0\n"},
                                                    {"a.off", "OFF 0 0 0\n"},
                                                    {"a.stl", "solid\nendsolid\n"}}) {
        const TriangleMesh mesh = read_bytes(sample.bytes, sample.name);
        EXPECT_EQ(mesh.triangle_count(), 0);
        ASSERT_EQ(mesh.warnings.size(), 1u) << sample.bytes;
        EXPECT_NE(mesh.warnings[0].find(sample.name + ": it holds no triangles"), std::string::npos)
            << mesh.warnings[0];
        EXPECT_EQ(error_of([&] { read_bytes(sample.bytes, sample.name, {.strict = true}); }).code, ErrorCode::format);
    }
}

TEST(MeshReading, last_line_needs_no_line_end) {
    for (Sample sample : samples()) {
        if (sample.bytes.back() != '\n') continue;
        SCOPED_TRACE(sample.name);
        const TriangleMesh whole = read_bytes(sample.bytes, sample.name);
        sample.bytes.pop_back();
        expect_same(read_bytes(sample.bytes, sample.name), whole);
    }
}

TEST(MeshReading, automatic_precision_is_float64_except_for_float32_files) {
    for (const Sample& sample : samples()) {
        const bool single = sample.name == "binary.stl";
        EXPECT_EQ(read_bytes(sample.bytes, sample.name).precision(), single ? ScalarType::float32 : ScalarType::float64)
            << sample.name;
        EXPECT_EQ(read_bytes(sample.bytes, sample.name, {.precision = Precision::float32}).precision(),
                  ScalarType::float32)
            << sample.name;
    }
}

TEST(MeshReading, decimal_numbers_are_rounded_to_float32_only_once) {
    // Slightly more than half way between two float32 numbers. If it were first rounded to float64, it would be half
    // way, and be rounded down, to even.
    const std::string text = "v 1.000000059604644775390626 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n";
    const auto mesh = read_bytes(text, "a.obj", {.precision = Precision::float32});
    EXPECT_EQ(coordinates(mesh)[0], double{0x1.000002p0f});
}

TEST(MeshReading, underflow_is_no_error) {
    const std::string text =
        "v 1e-999 -1e-46 1e-40\nv 0.000e999999999999999999999 0 0\nv 1e-99999999999999999999 0 0\nf 1 2 3\n";
    const auto x = coordinates(read_bytes(text, "a.obj", {.precision = Precision::float32}));
    EXPECT_EQ(x[0], 0);
    EXPECT_EQ(x[1], 0);
    EXPECT_TRUE(std::signbit(x[1])) << "an underflow keeps its sign";
    EXPECT_EQ(x[2], double{1e-40f});
    EXPECT_EQ(coordinates(read_bytes(text, "a.obj"))[1], -1e-46);
}

TEST(MeshReading, overflow_and_nonfinite_numbers_are_errors) {
    const auto vertex = [](const std::string& x) { return "v 0 0 0\nv 0 " + x + " 0\nv 0 0 0\nf 1 2 3\n"; };
    for (const char* const x : {"nan", "inf", "-inf", "-nan(1)", "1e999", "-1e400", "1e+309", "0x10", "1,5", "1.5x",
                                "--1", "+-1", ".", "-", "1e999999999999999999999"}) {
        SCOPED_TRACE(x);
        expect_bad(vertex(x), "a.obj", Element::line, 2, x);
    }
    expect_bad(vertex("3.5e38"), "a.obj", Element::line, 2, "overflows float32", {.precision = Precision::float32});
    EXPECT_EQ(coordinates(read_bytes(vertex("3.5e38"), "a.obj"))[4], 3.5e38);
    EXPECT_EQ(coordinates(read_bytes(vertex("+1.5"), "a.obj"))[4], 1.5);
}

TEST(MeshReading, numbers_are_rounded_to_nearest_if_the_caller_rounds_upward) {
    const std::string text = "v 0.1 0.2 0.3\nv 0 0 0\nv 0 0 0\nf 1 2 3\n";
    const Folder folder;
    const fs::path path = folder.write("a.obj", text);
    std::fesetround(FE_UPWARD);
    const TriangleMesh mesh = read_mesh(path);
    const int mode = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(mode, FE_UPWARD) << "the caller's mode is restored";
    const auto x = coordinates(mesh);
    EXPECT_EQ(x[0], 0.1);
    EXPECT_EQ(x[1], 0.2);
    EXPECT_EQ(x[2], 0.3);
}

TEST(MeshReading, welding_joins_equal_positions_and_keeps_the_first) {
    const std::string text = "v -0 1 2\nv 5 5 5\nv 0 1 2\nv 5 5 5.000001\nv 5 5 5\nf 1 2 4\nf 3 5 4\n";
    const TriangleMesh mesh = read_bytes(text, "a.obj", {.weld = Weld::yes});
    EXPECT_EQ(mesh.vertex_count(), 3);
    EXPECT_EQ(mesh.triangles, (std::vector<std::int32_t>{0, 1, 2, 0, 1, 2}));
    EXPECT_TRUE(std::signbit(coordinates(mesh)[0]));
    EXPECT_EQ(read_bytes(text, "a.obj").vertex_count(), 5) << "only STL is welded without being asked";
}

// Enough distinct positions for the hash table to grow several times; -0 equals 0.
TEST(MeshReading, welding_of_many_vertices_numbers_positions_by_first_occurrence) {
    constexpr int count = 30'000, distinct = 5'000;
    std::string text;
    std::map<int, std::int32_t> first;
    std::vector<std::int32_t> expected;
    std::mt19937 random(3);
    for (int v = 0; v < count; ++v) {
        const int position = static_cast<int>(random() % distinct);
        text +=
            "v " + std::to_string(position % 20) + ' ' + (v % 2 ? "0 " : "-0 ") + std::to_string(position / 20) + '\n';
        expected.push_back(first.try_emplace(position, static_cast<std::int32_t>(first.size())).first->second);
    }
    for (int v = 1; v < count; v += 3)
        text += "f " + std::to_string(v) + ' ' + std::to_string(v + 1) + ' ' + std::to_string(v + 2) + '\n';
    for (const Precision precision : {Precision::float32, Precision::float64}) {
        const TriangleMesh mesh = read_bytes(text, "a.obj", {.precision = precision, .weld = Weld::yes});
        EXPECT_EQ(mesh.vertex_count(), static_cast<std::int64_t>(first.size()));
        EXPECT_EQ(mesh.triangles, expected);
    }
}

TEST(MeshReading, vertices_are_welded_after_rounding_to_the_requested_precision) {
    const std::string text = "v 1 0 0\nv 1.00000000001 0 0\nv 0 0 0\nf 1 2 3\n";
    EXPECT_EQ(read_bytes(text, "a.obj", {.precision = Precision::float32, .weld = Weld::yes}).vertex_count(), 2);
    EXPECT_EQ(read_bytes(text, "a.obj", {.weld = Weld::yes}).vertex_count(), 3);
}

TEST(MeshReading, error_names_a_path_that_is_no_file) {
    const Folder folder;
    for (const fs::path& path : {folder / "missing.ply", folder.path(), fs::path("/dev/zero"), fs::path("")}) {
        const Error error = error_of([&] { read_mesh(path); });
        EXPECT_EQ(error.code, ErrorCode::file);
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    }
}

TEST(MeshReading, file_without_permission_is_an_error) {
    if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
    const Folder folder;
    const fs::path path = folder.write("a.obj", obj());
    fs::permissions(path, fs::perms::none);
    EXPECT_EQ(error_of([&] { read_mesh(path); }).code, ErrorCode::file);
}

TEST(MeshReading, empty_or_unknown_file_is_an_error) {
    for (const char* const name : {"a.ply", "a.stl", "a.off", "a"}) {
        EXPECT_EQ(error_of([&] { read_bytes("", name); }).code, ErrorCode::format) << name;
    }
    EXPECT_EQ(error_of([&] { read_bytes("hello world\n", "a.dat"); }).code, ErrorCode::format);
}

TEST(MeshReading, groups_are_read_only_from_ply) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const ReadOptions options{.group_property = "part"};
        if (sample.name.ends_with(".ply")) {
            EXPECT_EQ(read_bytes(sample.bytes, sample.name, options).groups, (std::vector<std::int32_t>{5, 5, -6}));
        } else {
            const Error error = error_of([&] { read_bytes(sample.bytes, sample.name, options); });
            EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        }
    }
}

TEST(MeshReading, byte_order_mark_before_text_is_skipped) {
    const std::string mark = "\xef\xbb\xbf";
    for (const Sample& sample : samples()) {
        const bool text = sample.name.starts_with("ascii") || sample.name.starts_with("square");
        if (!text) continue;
        SCOPED_TRACE(sample.name);
        for (const std::string& name : {sample.name, std::string("unnamed")})
            expect_same(read_bytes(mark + sample.bytes, name, {.precision = Precision::float64}), sample_mesh());
    }
    expect_bad(mark + "v 0 0 0\nv 1 x 0\n", "a.obj", Element::line, 2, "'x'");
    expect_bad(mark + mark + "v 0 0 0\n", "a.obj", Element::line, 1, "is not a statement");
}

TEST(MeshReading, error_holds_the_code_of_the_operating_system) {
    const Folder folder;
    EXPECT_EQ(error_of([&] { read_mesh(folder / "missing.ply"); }).system_error, ENOENT);
    EXPECT_EQ(error_of([&] { read_mesh(folder.path()); }).system_error, EISDIR);
    EXPECT_EQ(error_of([&] { read_bytes("OFF\n", "a.off"); }).system_error, 0);
}

}  // namespace
}  // namespace crumple::io::test
