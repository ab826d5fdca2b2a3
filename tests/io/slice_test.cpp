// Tests of reading a file by several readers, each of which reads a block of its vertices and triangles (a slice): all
// blocks in order give the mesh that one reader reads.

#include "io/bytes/slice.h"

#include <array>
#include <cstring>
#include <limits>

#include "files.h"

namespace crumple::io::test {
namespace {

/// Buffer that stores numbers in a given byte order.
class Bytes {
   public:
    explicit Bytes(std::endian order) : order_(order) {}
    template <class T>
    Bytes& operator<<(T value) {
        std::array<char, sizeof(T)> bytes = little_endian(value);
        if (order_ == std::endian::big) std::reverse(bytes.begin(), bytes.end());
        text_.append(bytes.data(), bytes.size());
        return *this;
    }
    Bytes& text(const std::string& text) { return text_ += text, *this; }
    const std::string& get() const { return text_; }

   private:
    std::endian order_;
    std::string text_;
};

constexpr std::int64_t vertex_count = 11, face_count = 7;

/// Mistake in an otherwise sound file.
struct Spoiled {
    std::int64_t vertex = -1, face = -1;  ///< index of the vertex or face with a mistake; -1: none
    std::uint8_t corners = 3;
    std::int64_t index = 0;
    float x = 0;
};

/// Returns a binary PLY with properties that readers skip and in an unusual order; groups are 100, 101, ...
std::string ply_bytes(std::endian order, const Spoiled& spoiled = {}) {
    Bytes bytes(order);
    bytes.text(
        std::string("ply\nformat binary_") + (order == std::endian::big ? "big" : "little") +
        "_endian 1.0\nelement material 2\nproperty short m\nelement vertex 11\nproperty uchar q\nproperty float z\n"
        "property double y\nproperty float x\nelement face 7\nproperty int group\nproperty list uchar int64 "
        "vertex_index\nproperty float w\nelement edge 1\nproperty int v\nend_header\n");
    bytes << std::int16_t{1} << std::int16_t{2};
    for (int v = 0; v < vertex_count; ++v)
        bytes << std::uint8_t{7} << 0.25f * static_cast<float>(v) << 1e-3 * v
              << (v == spoiled.vertex ? spoiled.x : static_cast<float>(v));
    for (int f = 0; f < face_count; ++f) {
        const bool bad = f == spoiled.face;
        bytes << std::int32_t{100 + f} << (bad ? spoiled.corners : std::uint8_t{3});
        const std::int64_t last = bad ? spoiled.index : 10 - f;
        bytes << std::int64_t{f} << std::int64_t{f + 1} << last << 1.5f;
    }
    return (bytes << std::int32_t{3}).get();
}

std::string stl_bytes(std::uint32_t triangles) {
    Bytes bytes(std::endian::little);
    bytes.text("solid, but binary").text(std::string(80 - 17, ' ')) << triangles;
    for (std::uint32_t t = 0; t < triangles; ++t) {
        for (std::uint32_t i = 0; i < 12; ++i) bytes << static_cast<float>((t * 7 + i * 3) % 5);
        bytes << std::uint16_t{0};
    }
    return bytes.get();
}

class Slices : public testing::Test {
   protected:
    std::optional<MeshSlice> slice(const std::string& bytes, const ReadOptions& options = {}, int reader = 0,
                                   int readers = 1, const std::string& name = "a.mesh") const {
        return read_slice(folder.write(name, bytes), options, reader, readers);
    }

    /// Reads the file by `readers` readers, and returns their blocks joined to one mesh.
    TriangleMesh joined(const std::string& bytes, int readers, const ReadOptions& options) const {
        TriangleMesh all;
        for (int r = 0; r < readers; ++r) {
            const auto part = slice(bytes, options, r, readers);
            if (!part) throw std::runtime_error("not read by slices");
            EXPECT_EQ(part->mesh.triangle_count(), part->triangles.size(r));
            EXPECT_EQ(part->mesh.vertex_count(), part->vertices.size(r));
            if (r == 0)
                std::visit([&](const auto& xyz) { all.vertices = std::decay_t<decltype(xyz)>(); }, part->mesh.vertices);
            all.triangles.insert(all.triangles.end(), part->mesh.triangles.begin(), part->mesh.triangles.end());
            all.groups.insert(all.groups.end(), part->mesh.groups.begin(), part->mesh.groups.end());
            std::visit(
                [&](const auto& xyz) {
                    auto& to = std::get<std::decay_t<decltype(xyz)>>(all.vertices);
                    to.insert(to.end(), xyz.begin(), xyz.end());
                },
                part->mesh.vertices);
        }
        return all;
    }

    void expect_same(const std::string& bytes, const ReadOptions& options = {}) const {
        const TriangleMesh expected = read_bytes(bytes, "a.mesh", options);
        for (const int readers : {1, 2, 3, 7, 20}) {
            const TriangleMesh mesh = joined(bytes, readers, options);
            EXPECT_EQ(mesh.vertices, expected.vertices) << readers;
            EXPECT_EQ(mesh.triangles, expected.triangles) << readers;
            EXPECT_EQ(mesh.groups, expected.groups) << readers;
        }
    }

    const Folder folder;
};

TEST_F(Slices, slices_of_ply_join_to_the_whole_mesh) {
    for (const std::endian order : {std::endian::little, std::endian::big})
        for (const Precision precision : {Precision::automatic, Precision::float32, Precision::float64})
            for (const char* group : {"", "group"})
                expect_same(ply_bytes(order), {.precision = precision, .group_property = group});
}

TEST_F(Slices, slices_of_stl_join_to_the_whole_mesh) {
    for (const Precision precision : {Precision::automatic, Precision::float64})
        expect_same(stl_bytes(30), {.precision = precision, .weld = Weld::no});
}

TEST_F(Slices, slices_state_whether_to_weld) {
    EXPECT_TRUE(slice(stl_bytes(3))->weld);
    EXPECT_FALSE(slice(stl_bytes(3), {.weld = Weld::no})->weld);
    EXPECT_FALSE(slice(ply_bytes(std::endian::little))->weld);
    EXPECT_TRUE(slice(ply_bytes(std::endian::little), {.weld = Weld::yes})->weld);
}

TEST_F(Slices, text_files_are_not_sliced) {
    EXPECT_FALSE(slice("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
    // The rows have as many bytes as binary ones, and the first of two readers has no face, so only the header shows
    // that they are text.
    const std::string ascii =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0.0 0.0 0.0\n1.0 0.0 0.0\n0.0 1.0 0.0\n3   0   1  2\n";
    EXPECT_EQ(read_bytes(ascii, "a.ply").triangle_count(), 1);
    EXPECT_FALSE(slice(ascii, {}, 0, 2));
    EXPECT_FALSE(slice(ascii));
}

TEST_F(Slices, files_of_a_wrong_length_are_not_sliced) {
    const std::string ply = ply_bytes(std::endian::little), stl = stl_bytes(3);
    for (const std::string& bytes : {ply, stl}) {
        EXPECT_TRUE(slice(bytes));
        EXPECT_FALSE(slice(bytes.substr(0, bytes.size() - 1)));
        EXPECT_FALSE(slice(bytes + ' '));
    }
    EXPECT_FALSE(slice(""));
}

TEST_F(Slices, files_without_triangles_or_the_group_property_are_not_sliced) {
    EXPECT_FALSE(slice(stl_bytes(0)));
    EXPECT_FALSE(slice(stl_bytes(3), {.group_property = "q"}));
    EXPECT_FALSE(slice(ply_bytes(std::endian::little), {.group_property = "q"}));
}

TEST_F(Slices, missing_files_folders_and_names_of_other_formats_are_not_sliced) {
    EXPECT_FALSE(read_slice(folder / "missing.ply", {}, 0, 1));
    EXPECT_FALSE(read_slice(folder.path(), {}, 0, 1));
    EXPECT_FALSE(slice(ply_bytes(std::endian::little), {}, 0, 1, "a.gltf"));
}

// Only the reader whose block has the polygon can detect it.
TEST_F(Slices, block_with_a_face_that_is_no_triangle_is_not_sliced) {
    for (const std::uint8_t corners : {std::uint8_t{2}, std::uint8_t{4}}) {
        const std::string ply = ply_bytes(std::endian::little, {.face = 6, .corners = corners});
        EXPECT_TRUE(slice(ply, {}, 0, 2));
        EXPECT_FALSE(slice(ply, {}, 1, 2));
    }
}

TEST_F(Slices, error_of_a_slice_equals_that_of_the_whole_file) {
    const float infinite = std::numeric_limits<float>::infinity();
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        for (const Spoiled& spoiled :
             {Spoiled{.vertex = 9, .x = infinite}, Spoiled{.face = 6, .index = 11}, Spoiled{.face = 6, .index = -1}}) {
            const std::string ply = ply_bytes(order, spoiled);
            EXPECT_TRUE(slice(ply, {}, 0, 2));
            const Error error = error_of([&] { slice(ply, {}, 1, 2); });
            const Error expected = error_of([&] { read_mesh(folder / "a.mesh"); });
            EXPECT_STREQ(error.what(), expected.what());
            EXPECT_EQ(error.index, expected.index);
            EXPECT_EQ(error.code, ErrorCode::format);
        }
    }
    std::string stl = stl_bytes(4);
    std::memset(stl.data() + 84 + 3 * 50 + 20, 0xff, 4);
    const Error error = error_of([&] { slice(stl, {}, 1, 2); });
    EXPECT_STREQ(error.what(), error_of([&] { read_mesh(folder / "a.mesh"); }).what());
}

TEST(Blocks, first_and_last_row_of_a_block_belong_to_its_reader) {
    for (const std::int64_t rows : {1, 2, 7, 64, 2147483647}) {
        for (const int readers : {1, 2, 3, 64}) {
            const Blocks blocks{rows, readers};
            EXPECT_EQ(blocks.begin(0), 0);
            EXPECT_EQ(blocks.end(readers - 1), rows);
            for (int r = 0; r < readers; ++r) {
                if (blocks.size(r) == 0) continue;
                EXPECT_EQ(blocks.reader_of(blocks.begin(r)), r);
                EXPECT_EQ(blocks.reader_of(blocks.end(r) - 1), r);
            }
        }
    }
}

}  // namespace
}  // namespace crumple::io::test
