// Tests of 3MF that is cut, damaged or absurd: it gives an error or a valid mesh, never a crash, a hang or a huge
// allocation.

#include <cmath>

#include "3mf_file.h"
#include "files.h"

namespace crumple::io::test {
namespace {

using crumple::test::file_3mf;
using crumple::test::model_around;
using crumple::test::PackageParts;
using crumple::test::relationships;
using crumple::test::tetrahedron;

/// Expects an error in this line of a model with these children.
void expect_refused(const std::string& children, std::int64_t line, const std::string& what) {
    SCOPED_TRACE(children.substr(0, 300));
    expect_bad(file_3mf(model_around(children)), "a.3mf", Element::line, line, what);
}

std::string one_object(const std::string& inside, const std::string& build = "<item objectid=\"1\"/>") {
    return "<resources><object id=\"1\">\n" + inside + "\n</object></resources><build>" + build + "</build>";
}

std::string one_mesh(const std::string& vertex, const std::string& triangle) {
    return one_object("<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>\n" + vertex +
                      "</vertices><triangles>\n" + triangle + "</triangles></mesh>");
}

const std::string good_vertex = "<vertex x=\"0\" y=\"1\" z=\"0\"/>",
                  good_triangle = "<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>";

TEST(HostileThreeMf, invalid_coordinates_and_indices_are_refused_with_their_line) {
    EXPECT_EQ(read_bytes(file_3mf(model_around(one_mesh(good_vertex, good_triangle))), "a.3mf").triangle_count(), 1);
    expect_refused(one_mesh(R"(<vertex x="nan" y="1" z="0"/>)", good_triangle), 5, "'nan' is not a finite number");
    expect_refused(one_mesh(R"(<vertex x="1e999" y="1" z="0"/>)", good_triangle), 5, "overflows float64");
    expect_refused(one_mesh(R"(<vertex x="1,5" y="1" z="0"/>)", good_triangle), 5, "'1,5' is not");
    expect_refused(one_mesh(R"(<vertex x="" y="1" z="0"/>)", good_triangle), 5, "'' is not");
    expect_refused(one_mesh(R"(<vertex x="1" y="1"/>)", good_triangle), 5, "a vertex lacks z");
    expect_refused(one_mesh(good_vertex, R"(<triangle v1="0" v2="1" v3="3"/>)"), 6, "names vertex 3 of 3");
    expect_refused(one_mesh(good_vertex, R"(<triangle v1="0" v2="1" v3="-1"/>)"), 6, "'-1', which is not an index");
    expect_refused(one_mesh(good_vertex, R"(<triangle v1="0" v2="1" v3="4294967296"/>)"), 6, "not an index");
    expect_refused(one_mesh(good_vertex, R"(<triangle v1="0" v2="1"/>)"), 6, "a triangle lacks v3");
    expect_bad(file_3mf(model_around(one_mesh(R"(<vertex x="1e39" y="1" z="0"/>)", good_triangle))), "a.3mf",
               Element::line, 5, "overflows float32", {.precision = Precision::float32});
}

TEST(HostileThreeMf, invalid_objects_references_and_transforms_are_refused) {
    expect_refused(one_object(tetrahedron, "\n<item objectid=\"2\"/>"), 8, "there is no object 2");
    expect_refused(one_object(tetrahedron, "\n<item/>"), 8, "an item lacks objectid");
    expect_refused(one_object(tetrahedron, "\n<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0\"/>"), 8,
                   "fewer than 12");
    expect_refused(one_object(tetrahedron, "\n<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 0 0\"/>"), 8,
                   "more than 12");
    expect_refused(one_object(tetrahedron, "\n<item objectid=\"1\" transform=\"inf 0 0 0 1 0 0 0 1 0 0 0\"/>"), 8,
                   "not a finite");
    expect_refused(one_object(tetrahedron + "\n" + tetrahedron), 7, "must hold either one mesh or components");
    expect_refused(one_object(""), 3, "holds neither a mesh nor components");
    expect_refused("<resources><object id=\"1\"/>\n<object id=\"1\"/></resources>", 4, "already, in line 3");
    expect_refused("<resources><object id=\"1\" type=\"ghost\"/></resources>", 3, "'ghost'");
    expect_refused(one_object("<components>\n<component objectid=\"1\"/></components>"), 5, "a component of itself");
    const std::string far = "<item objectid=\"1\" transform=\"1e300 0 0 0 1 0 0 0 1 0 0 0\"/>";
    expect_refused("<resources><object id=\"2\">" + tetrahedron + "</object><object id=\"1\"><components>\n" +
                       "<component objectid=\"2\" transform=\"1e300 0 0 0 1 0 0 0 1 0 0 0\"/></components></object>" +
                       "</resources><build>" + far + "</build>",
                   6, "not finite");
    std::string children = one_mesh(R"(<vertex x="1e300" y="1" z="0"/>)", good_triangle);
    const std::string item = "<item objectid=\"1\"/>";
    children.replace(children.find(item), item.size(), far);
    const Error error = error_of([&] { read_bytes(file_3mf(model_around(children)), "a.3mf"); });
    EXPECT_TRUE(contains(error.what(), "a transform makes a vertex overflow")) << error.what();
}

TEST(HostileThreeMf, deep_and_exponential_assemblies_are_refused) {
    const auto chain = [](int length, int copies) {
        std::string children = "<resources><object id=\"0\">" + tetrahedron + "</object>";
        for (int i = 1; i <= length; ++i) {
            children += "<object id=\"" + std::to_string(i) + "\"><components>";
            for (int k = 0; k < copies; ++k) children += "<component objectid=\"" + std::to_string(i - 1) + "\"/>";
            children += "</components></object>";
        }
        return model_around(children + "</resources><build><item objectid=\"" + std::to_string(length) +
                            "\"/></build>");
    };
    EXPECT_EQ(read_bytes(file_3mf(chain(60, 1)), "a.3mf").triangle_count(), 4);
    expect_bad(file_3mf(chain(70, 1)), "a.3mf", Element::line, 5, "nested more than 64 deep");
    expect_bad(file_3mf(chain(40, 2)), "a.3mf", Element::line, 5, "more than 65536 objects");
}

// Refers 60,000 times to 500 triangles: a world stores only the poses, but one mesh would take 700 MB.
TEST(HostileThreeMf, excessively_repeated_mesh_is_read_as_bodies_but_not_as_one_mesh) {
    std::string mesh =
        "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"
        "<vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles>";
    for (int i = 0; i < 500; ++i) mesh += "<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>";
    std::string items = "<resources><object id=\"1\">" + mesh + "</triangles></mesh></object></resources><build>";
    for (int i = 0; i < 60000; ++i) items += "<item objectid=\"1\"/>";
    const std::string file = file_3mf(model_around(items + "</build>"));
    const Error error = error_of([&] { read_bytes(file, "a.3mf"); });
    EXPECT_NE(std::string(error.what()).find("a.3mf: it refers to meshes so often that they have 30000000 triangles"),
              std::string::npos)
        << error.what();
    std::istringstream in(file);
    EXPECT_EQ(io::read_world(in, "a.3mf").bodies.size(), 60000u);
}

TEST(HostileThreeMf, doctypes_and_entities_are_refused) {
    const std::string laughs =
        "<?xml version=\"1.0\"?>\n<!DOCTYPE model [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;\">]>\n"
        "<model>&b;</model>";
    expect_bad(file_3mf(laughs), "a.3mf", Element::line, 2, "a DOCTYPE");
    expect_bad(file_3mf("<model>\n&b;</model>"), "a.3mf", Element::line, 1, "not a 3MF model");
    expect_refused("\n&b;", 4, "not valid XML");
    std::string deep;
    for (int i = 0; i < 10'000; ++i) deep += "<a>";
    expect_refused(deep, 3, "nested more than 256 deep");
    expect_refused("<metadata name=\"" + std::string(3 << 20, 'x') + "\"/>", 3, "longer than 1 MiB");
}

TEST(HostileThreeMf, error_names_the_missing_part_of_a_package) {
    const std::string model = model_around(one_object(tetrahedron));
    const auto expect_error = [](const PackageParts& parts, const std::string& what) {
        const Error error = error_of([&] { read_bytes(parts.bytes(), "a.3mf"); });
        EXPECT_EQ(error.code, ErrorCode::format);
        EXPECT_TRUE(contains(error.what(), "a.3mf") && contains(error.what(), what)) << error.what();
    };
    expect_error({}, "'_rels/.rels' is missing");
    expect_error({{"a.txt", "a"}}, "'_rels/.rels' is missing");
    expect_error({{"_rels/.rels", relationships}}, "'3D/3dmodel.model' is missing");
    expect_error(
        {{"_rels/.rels", "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"/>"}},
        "refers to no model");
    expect_error({{"_rels/.rels", relationships},
                  {"3D/3dmodel.model", model_around("<build><item p:path=\"/3D/b.model\" objectid=\"1\"/></build>")}},
                 "'3D/b.model' is missing");
    const Error empty = error_of([&] { read_bytes("something else", "a.3mf"); });
    EXPECT_TRUE(contains(empty.what(), "not a 3MF archive")) << empty.what();
}

TEST(HostileThreeMf, expansion_beyond_256_mib_is_an_error) {
    const PackageParts parts{{"_rels/.rels", relationships},
                             {"3D/3dmodel.model", model_around(std::string(std::size_t{300} << 20, ' '))}};
    const std::string bytes = parts.bytes();
    ASSERT_LT(bytes.size(), 1u << 20);
    const Error error = error_of([&] { read_bytes(bytes, "a.3mf"); });
    EXPECT_TRUE(contains(error.what(), "more than 256 MiB")) << error.what();
}

/// Cuts an archive, and changes one bit of each of its bytes: checksums detect most of these changes.
TEST(HostileThreeMf, truncation_is_an_error_and_a_flipped_bit_is_an_error_or_gives_a_valid_mesh) {
    const PackageParts parts{{"_rels/.rels", relationships},
                             {"3D/3dmodel.model", model_around(one_object(tetrahedron))}};
    for (const ZipWriter::Method method : {ZipWriter::Method::store, ZipWriter::Method::deflate}) {
        const std::string whole = parts.bytes(method);
        const auto expect_error_or_valid = [](const std::string& bytes) {
            try {
                const TriangleMesh mesh = read_bytes(bytes, "a.3mf");
                for (const std::int32_t corner : mesh.triangles)
                    ASSERT_TRUE(corner >= 0 && corner < mesh.vertex_count()) << corner;
                for (const double x : coordinates(mesh)) ASSERT_TRUE(std::isfinite(x)) << x;
            } catch (const Error& error) {
                EXPECT_TRUE(contains(error.what(), "a.3mf")) << error.what();
            }
        };
        for (std::size_t size = 0; size < whole.size(); size += 3)
            error_of([&] { read_bytes(whole.substr(0, size), "a.3mf"); });
        for (std::size_t i = 0; i < whole.size(); ++i) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ (1 << (i % 8)));
            expect_error_or_valid(changed);
        }
    }
}

}  // namespace
}  // namespace crumple::io::test
