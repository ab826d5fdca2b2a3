#include <cmath>

#include "samples.h"

namespace crumple::io::test {
namespace {

const std::string xyz_float = "property float x\nproperty float y\nproperty float z\n";
const std::string three_vertices = "element vertex 3\n" + xyz_float;
const std::string one_face = "element face 1\nproperty list uchar int vertex_indices\n";

std::string ascii(const std::string& header, const std::string& body) {
    return "ply\nformat ascii 1.0\n" + header + "end_header\n" + body;
}

const TriangleMesh corner{std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, {}};
const std::string corner_rows = "0 0 0\n1 0 0\n0 1 0\n";

TEST(Ply, property_types_decide_the_precision) {
    const auto precision = [](const char* x, const char* z) {
        const std::string header = std::string("element vertex 3\nproperty ") + x + " x\nproperty " + x +
                                   " y\nproperty " + z + " z\n" + one_face;
        return read_bytes(ascii(header, corner_rows + "3 0 1 2\n"), "a.ply").precision();
    };
    EXPECT_EQ(precision("float", "float32"), ScalarType::float32);
    EXPECT_EQ(precision("double", "float64"), ScalarType::float64);
    EXPECT_EQ(precision("float", "double"), ScalarType::float64);
    EXPECT_EQ(precision("int", "int"), ScalarType::float64);
}

TEST(Ply, every_integer_type_of_lists_is_read) {
    const auto check = [](std::endian order, auto count, const char* count_name, auto index, const char* index_name) {
        const std::string encoding = order == std::endian::little ? "little" : "big";
        const std::string header = "ply\nformat binary_" + encoding + "_endian 1.0\n" + three_vertices +
                                   "element face 1\nproperty list " + count_name + " " + index_name +
                                   " vertex_index\nend_header\n";
        const auto i = [&](int value) { return static_cast<decltype(index)>(value); };
        const std::string body = packed(order, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f) +
                                 packed(order, static_cast<decltype(count)>(3), i(0), i(1), i(2));
        SCOPED_TRACE(header);
        expect_same(read_bytes(header + body, "a.ply"), corner);
    };
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        check(order, std::int8_t{}, "char", std::int8_t{}, "int8");
        check(order, std::uint8_t{}, "uchar", std::uint8_t{}, "uint8");
        check(order, std::int16_t{}, "short", std::int16_t{}, "int16");
        check(order, std::uint16_t{}, "ushort", std::uint16_t{}, "uint16");
        check(order, std::int32_t{}, "int", std::int32_t{}, "int32");
        check(order, std::uint32_t{}, "uint", std::uint32_t{}, "uint32");
        check(order, std::int64_t{}, "int64", std::int64_t{}, "int64");
        check(order, std::uint64_t{}, "uint64", std::uint64_t{}, "uint64");
        check(order, std::uint8_t{}, "uint8", std::uint32_t{}, "uint");
    }
}

TEST(Ply, faces_can_precede_vertices_and_other_elements_are_skipped) {
    const std::string header = "element edge 2\nproperty int a\nproperty list int float w\n" + one_face +
                               "element nothing 1000000000000\n" + three_vertices +
                               "element material 1\nproperty list uint uchar name\n";
    expect_same(read_bytes(ascii(header, "7 2 .5 .5\n8 0\n3 0 1 2\n" + corner_rows + "4 65 66 67 68\n"), "a.ply"),
                corner);
}

TEST(Ply, unused_properties_of_vertices_and_faces_are_skipped) {
    const std::string header =
        "element vertex 3\nproperty list uchar int bones\nproperty float x\nproperty uchar red\nproperty float y\n"
        "property float z\nproperty double nx\nproperty list uchar float weights\n"
        "element face 1\nproperty uchar flags\nproperty list uchar float texcoord\n"
        "property list uchar int vertex_indices\nproperty list uchar uchar tail\n";
    const std::string body =
        "2 5 6 0 255 0 0 1e999 1 .5\n0 1 255 0 0 nan 0\n1 9 0 255 1 0 7 2 .1 .2\n"
        "1 6 0 0 1 0 0 1 3 0 1 2 2 1 1\n";
    expect_same(read_bytes(ascii(header, body), "a.ply"), corner);
}

TEST(Ply, convex_polygon_is_fanned_from_its_first_corner) {
    const std::string header = "element vertex 5\n" + xyz_float + one_face;
    const std::string body = "0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n5 3 4 0 1 2\n";
    EXPECT_EQ(read_bytes(ascii(header, body), "a.ply").triangles,
              (std::vector<std::int32_t>{3, 4, 0, 3, 0, 1, 3, 1, 2}));
}

TEST(Ply, integer_property_of_faces_is_read_as_groups_on_request) {
    for (const char* const type : {"char", "uchar", "short", "ushort", "int", "uint", "int64"}) {
        const std::string header =
            three_vertices + "element face 2\nproperty " + type + " object\nproperty list uchar int vertex_indices\n";
        const std::string bytes = ascii(header, corner_rows + "7 3 0 1 2\n9 3 2 1 0\n");
        EXPECT_EQ(read_bytes(bytes, "a.ply", {.group_property = "object"}).groups, (std::vector<std::int32_t>{7, 9}));
        EXPECT_TRUE(read_bytes(bytes, "a.ply").groups.empty()) << "groups are read only if asked for";
    }
}

TEST(Ply, missing_or_unsuitable_group_property_is_refused) {
    const std::string header = three_vertices +
                               "element face 1\nproperty uint big\nproperty float real\n"
                               "property list uchar int vertex_indices\n";
    const std::string bytes = ascii(header, corner_rows + "4000000000 1 3 0 1 2\n");
    expect_bad(bytes, "a.ply", Element::line, 15, "32 bits", {.group_property = "big"});
    expect_bad(bytes, "a.ply", Element::line, 7, "not an integer", {.group_property = "real"});
    const Error missing = error_of([&] { read_bytes(bytes, "a.ply", {.group_property = "missing"}); });
    EXPECT_EQ(missing.code, ErrorCode::invalid_argument);
    EXPECT_NE(std::string(missing.what()).find("a.ply: its faces have no property 'missing'"), std::string::npos);
    expect_bad(bytes, "a.ply", Element::line, 7, "no scalar", {.group_property = "vertex_indices"});
}

TEST(Ply, error_in_the_header_names_the_line) {
    const auto bad = [](const std::string& bytes, std::int64_t line, const char* what) {
        SCOPED_TRACE(bytes);
        expect_bad(bytes, "a.ply", Element::line, line, what);
    };
    bad("ply\nformat ascii 2.0\nend_header\n", 2, "version");
    bad("ply\nformat utf8 1.0\nend_header\n", 2, "unknown format 'utf8'");
    bad("ply\nelement vertex 1\nend_header\n", 3, "no format");
    bad("ply\nformat ascii 1.0\nelement vertex 1\n", 4, "no line end_header");
    bad("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", 3, "not a count");
    bad("ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nend_header\n", 3, "not a count");
    bad("ply\nformat ascii 1.0\nproperty int x\nend_header\n", 3, "precedes the first element");
    bad("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n", 4, "unknown type 'real'");
    bad("ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\nend_header\n", 4,
        "count must be an integer");
    bad("ply\nformat ascii 1.0\nelephant\nend_header\n", 3, "'elephant'");
    bad("ply\nformat ascii 1.0\nend_header\n", 3, "no element 'vertex'");
    bad(ascii("element vertex 0\nproperty float x\nproperty float y\n" + one_face, ""), 3, "no scalar 'z'");
    bad(ascii("element vertex 0\n" + xyz_float + "property float x\n" + one_face, ""), 3, "two properties 'x'");
    bad(ascii(three_vertices + three_vertices + one_face, ""), 7, "there is a second element 'vertex'");
    bad(ascii(three_vertices + "element face 1\nproperty list uchar float vertex_indices\n", ""), 7,
        "no list of integers");
    bad(ascii(three_vertices + "element face 1\nproperty int vertex_indices\n", ""), 7, "no list of integers");
}

TEST(Ply, error_in_the_body_names_the_line) {
    const auto bad = [](const std::string& body, std::int64_t line, const char* what) {
        SCOPED_TRACE(body);
        expect_bad(ascii(three_vertices + one_face, body), "a.ply", Element::line, line, what);
    };
    bad(corner_rows + "3 0 1 3\n", 13, "vertex 3 of 3");
    bad(corner_rows + "3 0 1 -1\n", 13, "vertex -1 of 3");
    bad(corner_rows + "2 0 1 2 1\n", 13, "data follows");
    bad(corner_rows + "-3 0 1 2\n", 13, "-3 values");
    bad(corner_rows + "2147483648 0 1 2\n", 13, "2147483648 values");
    bad(corner_rows + "3 0 1.5 2\n", 13, "'.5'");
    bad(corner_rows + "3 0 1 2\n3 0 1 2\n", 14, "data follows");
    bad("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", 11, "'nan'");
    bad("0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n", 11, "overflows float32");
}

TEST(Ply, error_in_binary_data_names_the_byte) {
    const auto bytes = [](double y, std::uint8_t corners, int last, const std::string& tail = "") {
        return "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\n"
               "property float z\n" +
               one_face + "end_header\n" +
               packed(std::endian::big, 0.f, 0., 0.f, 1.f, y, 0.f, 0.f, 1., 0.f, corners, 0, 1, last) + tail;
    };
    const std::string good = bytes(0, 3, 2);
    const auto body = static_cast<std::int64_t>(good.find("end_header\n")) + 11;
    EXPECT_EQ(read_bytes(good, "a.ply").triangle_count(), 1);
    EXPECT_EQ(read_bytes(good + "\r\n", "a.ply").triangle_count(), 1) << "blanks may follow";
    expect_bad(bytes(std::nan(""), 3, 2), "a.ply", Element::byte, body + 20, "not finite");
    expect_bad(bytes(1e300, 3, 2), "a.ply", Element::byte, body + 20, "float32", {.precision = Precision::float32});
    expect_bad(bytes(0, 2, 2), "a.ply", Element::byte, body + 57, "data follows");
    expect_bad(bytes(0, 4, 2), "a.ply", Element::byte, body + 48, "4 values");
    expect_bad(bytes(0, 3, 3), "a.ply", Element::byte, body + 57, "vertex 3 of 3");
    expect_bad(bytes(0, 3, 2, "x"), "a.ply", Element::byte, body + 61, "data follows");
}

TEST(Ply, empty_mesh_is_valid) {
    const TriangleMesh mesh = read_bytes(
        ascii("element vertex 0\n" + xyz_float + "element face 0\nproperty list uchar int vertex_indices\n", ""),
        "a.ply");
    EXPECT_EQ(mesh.vertex_count(), 0);
    EXPECT_EQ(mesh.triangle_count(), 0);
}

TEST(Ply, triangle_strips_flip_every_other_triangle) {
    const std::string vertices = "element vertex 5\n" + xyz_float, rows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n",
                      strips = "element tristrips 2\nproperty list int int vertex_indices\n";
    const auto triangles = [&](const std::string& lists) {
        return read_bytes(ascii(vertices + strips, rows + lists), "a.ply").triangles;
    };
    using Indices = std::vector<std::int32_t>;
    EXPECT_EQ(triangles("4 0 1 2 3\n0\n"), (Indices{0, 1, 2, 2, 1, 3}));
    EXPECT_EQ(triangles("5 0 1 2 3 4\n3 4 1 0\n"), (Indices{0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 1, 0}));
    EXPECT_EQ(triangles("8 0 1 2 3 -1 2 3 4\n2 0 1\n"), (Indices{0, 1, 2, 2, 1, 3, 2, 3, 4})) << "-1 begins anew";
    EXPECT_EQ(triangles("7 0 1 2 2 3 3 4\n2 -1 -1\n"), (Indices{0, 1, 2})) << "jumps are no triangles";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
    EXPECT_EQ(read_bytes(ascii(vertices + faces + strips, rows + "3 4 3 2\n3 0 1 2\n0\n"), "a.ply").triangles,
              (Indices{4, 3, 2, 0, 1, 2}));
    expect_bad(ascii(vertices + strips, rows + "3 0 1 5\n0\n"), "a.ply", Element::line, 15,
               "a strip names vertex 5 of 5");
    expect_bad(ascii(vertices + strips, rows + "3 0 1 -2\n0\n"), "a.ply", Element::line, 15,
               "a strip names vertex -2 of 5");
}

TEST(Ply, vertices_without_faces_are_read_as_points_on_request) {
    const std::string text = ascii("element vertex 2\n" + xyz_float, "0 0 0\n1 2 3\n");
    const TriangleMesh mesh = read_bytes(text, "a.ply");
    EXPECT_EQ(coordinates(mesh), (std::vector<double>{0, 0, 0, 1, 2, 3}));
    EXPECT_TRUE(mesh.triangles.empty() && mesh.points.empty());
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_TRUE(contains(mesh.warnings[0], "a.ply: it holds no triangles")) << mesh.warnings[0];
    EXPECT_EQ(read_bytes(text, "a.ply", {.lines_and_points = true}).points, (std::vector<std::int32_t>{0, 1}));
}

TEST(Ply, faces_with_fewer_than_three_corners_give_a_warning) {
    const std::string faces = "element face 3\nproperty int g\nproperty list uchar int vertex_indices\n";
    const TriangleMesh mesh =
        read_bytes(ascii(three_vertices + faces, corner_rows + "7 3 0 1 2\n8 2 0 1\n9 4 0 1 2 0\n"), "a.ply",
                   {.group_property = "g"});
    EXPECT_EQ(mesh.triangles, (std::vector<std::int32_t>{0, 1, 2, 0, 1, 2, 0, 2, 0}));
    EXPECT_EQ(mesh.groups, (std::vector<std::int32_t>{7, 9, 9}));
    EXPECT_EQ(mesh.polygons.offsets, (std::vector<std::int64_t>{0, 3, 7}));
    ASSERT_EQ(mesh.warnings.size(), 1u);
    EXPECT_NE(mesh.warnings[0].find("a face has fewer than three corners and is left out"), std::string::npos);
}

}  // namespace
}  // namespace crumple::io::test
