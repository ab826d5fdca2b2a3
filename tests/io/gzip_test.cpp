// Tests of gzip: compressed files are recognised by content when read, and by name when written.

#include <zlib.h>

#include <sstream>

#include "3mf_file.h"
#include "files.h"
#include "io/bytes/gzip.h"
#include "io/bytes/slice.h"

namespace crumple::io::test {
namespace {

/// Returns the bytes compressed by zlib alone.
std::string gzipped(std::string_view bytes) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
    std::string out(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

std::string gunzipped(const fs::path& path) {
    const std::string bytes = bytes_of(path);
    EXPECT_TRUE(is_gzip(bytes)) << path;
    const Array<char> expanded = expand_gzip(bytes, "file");
    return {expanded.data(), expanded.size()};
}

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 0.1 0\nf 1 2 3\n";

TEST(Gzip, gzip_is_recognised_by_its_content) {
    const TriangleMesh plain = read_bytes(triangle, "a.obj");
    for (const char* const name : {"a.obj.gz", "a.obj", "a", "a.GZ"})
        expect_same(read_bytes(gzipped(triangle), name), plain);
    std::istringstream in(gzipped(triangle));
    expect_same(read_mesh(in, "standard input"), plain);
    const crumple::test::PackageParts zip{{"a.obj.gz", gzipped(triangle)}};
    expect_same(read_bytes(zip.bytes(), "a.zip"), plain);
    expect_bad(gzipped("v 0 0 0\nv 1 x 0\n"), "a.obj.gz", Element::line, 2, "'x'");
    const Folder folder;
    EXPECT_EQ(read_world(folder.write("part.obj.gz", gzipped(triangle))).bodies.at(0).name, "part");
    EXPECT_EQ(read_pairs(folder.write("p.csv.gz", gzipped("a,b\n1,2\n"))).size(), 1u);
    EXPECT_EQ(read_world(folder.write("a.3mf.gz", gzipped(crumple::test::file_3mf(crumple::test::model_around(
                                                      "<resources><object id=\"1\">" + crumple::test::tetrahedron +
                                                      "</object></resources><build><item objectid=\"1\"/></build>")))))
                  .bodies.size(),
              1u);
}

TEST(Gzip, writers_compress_if_the_file_name_ends_in_gz) {
    const Folder folder;
    const TriangleMesh mesh = read_bytes(triangle, "a.obj");
    for (const std::string name : {"a.obj", "a.off", "a.ply", "a.stl", "a.3mf"}) {
        write_mesh(folder / name, mesh);
        write_mesh(folder / (name + ".gz"), mesh);
        write_mesh(folder / (name + ".GZ"), mesh);
        EXPECT_EQ(gunzipped(folder / (name + ".gz")), bytes_of(folder / name)) << name;
        EXPECT_EQ(bytes_of(folder / (name + ".gz")), bytes_of(folder / (name + ".GZ"))) << name;
    }
    Intersections found;
    found.pairs.push_back({1, 2});
    for (const std::string name : {"p.txt", "p.csv", "p.json", "p.npz"}) {
        write_pairs(folder / name, found);
        write_pairs(folder / (name + ".gz"), found);
        EXPECT_EQ(gunzipped(folder / (name + ".gz")), bytes_of(folder / name)) << name;
        EXPECT_EQ(read_pairs(folder / (name + ".gz")), read_pairs(folder / name)) << name;
    }
    found.hit.push_back(1);
    write_coloured(folder / "c.obj.gz", mesh, nullptr, found);
    EXPECT_TRUE(fs::exists(folder / "c.mtl"));
    EXPECT_TRUE(contains(gunzipped(folder / "c.obj.gz"), "mtllib c.mtl"));
    EXPECT_EQ(error_of([&] { write_mesh(folder / "a.gz", mesh); }).code, ErrorCode::invalid_argument);
}

/// Uses incompressible data many times as large as every buffer.
TEST(Gzip, large_files_keep_every_byte) {
    const Folder folder;
    std::string bytes(std::size_t{3} << 20, '\0');
    std::uint32_t state = 1;
    for (char& c : bytes) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
    for (const std::size_t size : {bytes.size(), std::size_t{1 << 16}, std::size_t{(1 << 16) + 1}, std::size_t{0}}) {
        write_bytes(folder / "a.gz", std::string_view(bytes).substr(0, size));
        EXPECT_EQ(gunzipped(folder / "a.gz"), bytes.substr(0, size));
    }
}

TEST(Gzip, several_members_are_joined) {
    const std::string begin = triangle.substr(0, 10), end = triangle.substr(10);
    expect_same(read_bytes(gzipped(begin) + gzipped("") + gzipped(end), "a.obj.gz"), read_bytes(triangle, "a.obj"));
}

TEST(Gzip, truncation_wrong_checksum_wrong_length_and_extra_data_are_errors) {
    const std::string whole = gzipped(triangle);
    for (std::size_t size = 2; size < whole.size(); ++size) {
        const Error error = error_of([&] { read_bytes(whole.substr(0, size), "a.obj.gz"); });
        EXPECT_TRUE(contains(error.what(), "a.obj.gz, byte " + std::to_string(size) + ": the gzip data is truncated"))
            << error.what();
    }
    const auto end = static_cast<std::int64_t>(whole.size());
    expect_bad(whole + "x", "a.obj.gz", Element::byte, end, "other data follows");
    expect_bad(whole + std::string(4, '\0'), "a.obj.gz", Element::byte, end, "other data follows");
    for (const std::size_t place : {whole.size() - 1, whole.size() - 8}) {  // length, checksum
        std::string changed = whole;
        changed[place] = static_cast<char>(changed[place] ^ 1);
        EXPECT_TRUE(contains(error_of([&] { read_bytes(changed, "a.obj.gz"); }).what(), "damaged"));
    }
}

TEST(Gzip, expansion_beyond_256_mib_is_an_error) {
    const std::string bomb = gzipped(std::string((std::size_t{256} << 20) + 1, ' '));
    const Error error = error_of([&] { read_bytes(bomb, "a.obj.gz"); });
    EXPECT_TRUE(contains(error.what(), "more than 256 MiB")) << error.what();
}

TEST(Gzip, compressed_files_are_not_sliced) {
    const Folder folder;
    write_mesh(folder / "a.ply.gz", read_bytes(triangle, "a.obj"));
    EXPECT_FALSE(read_slice(folder / "a.ply.gz", {}, 0, 2));
    write_mesh(folder / "a.ply", read_bytes(triangle, "a.obj"));
    EXPECT_TRUE(read_slice(folder / "a.ply", {}, 0, 2));
}

}  // namespace
}  // namespace crumple::io::test
