// Checks that lists of pairs are read as they were written, and that errors in lists name the place.

#include <cstring>

#include "collisions.h"
#include "files.h"
#include "io/bytes/zip.h"
#include "numpy.h"

namespace crumple::io::test {
namespace {

using Pairs = std::vector<Pair>;

void expect_bad_list(const std::string& bytes, const std::string& name, const std::string& what) {
    const Folder folder;
    const Error error = error_of([&] { read_pairs(folder.write(name, bytes)); });
    EXPECT_EQ(error.code, ErrorCode::format) << name << ": " << error.what();
    const std::string message = error.what();
    EXPECT_NE(message.find(name), message.npos) << message;
    EXPECT_NE(message.find(what), message.npos) << message;
}

TEST(PairReading, every_format_reads_back_what_was_written) {
    const Folder folder;
    for (const char* const name : {"a.txt", "a.csv", "a.json", "a.npz", "A.CSV"}) {
        for (const bool contacts : {false, true}) {
            const Intersections c = example(contacts);
            write_pairs(folder / name, c);
            EXPECT_EQ(read_pairs(folder / name), Pairs(c.pairs.begin(), c.pairs.end())) << name;
        }
        write_pairs(folder / name, {});
        EXPECT_TRUE(read_pairs(folder / name).empty()) << name;
    }
}

TEST(PairReading, text_can_have_comments_and_further_columns) {
    const Folder folder;
    EXPECT_TRUE(read_pairs(folder.write("empty.txt", "")).empty());
    EXPECT_EQ(read_pairs(folder.write("b.txt", "# a b\r\n3 4\r\n\r\n  5\t6 7 8 # more\n1 2")),
              (Pairs{{3, 4}, {5, 6}, {1, 2}}));
    EXPECT_EQ(read_pairs(folder.write("d.txt", "0,1\n2, 3\n4 ,5,6\r7,8")), (Pairs{{0, 1}, {2, 3}, {4, 5}, {7, 8}}));
    EXPECT_EQ(read_pairs(folder.write("c.txt",
                                      "\xef\xbb\xbf"
                                      "3 4\n")),
              (Pairs{{3, 4}}));
}

TEST(PairReading, error_in_text_names_the_line) {
    const Folder folder;
    for (const char* const bad : {"1", "a b", "1 b", "-1 2", "1 2147483648", "1.5 2", "1 99999999999999999999", "1;2",
                                  "1,,2", ",1 2", "1, ", "1x 2", "1 2x"}) {
        const Error error =
            error_of([&] { read_pairs(folder.write("a.txt", std::string("0 1\n\n") + bad + "\n4 5\n")); });
        EXPECT_EQ(error.code, ErrorCode::format) << bad;
        EXPECT_EQ(error.element, Element::line) << bad;
        EXPECT_EQ(error.index, 3) << error.what();
    }
    EXPECT_EQ(error_of([&] { read_pairs(folder / "missing.txt"); }).code, ErrorCode::file);
}

TEST(PairReading, csv_can_lack_its_header) {
    const Folder folder;
    const Pairs expected{{0, 1}, {2, 3}};
    for (const char* const text : {"0,1\n2,3\n", "first,second\r\n0,1\r\n\r\n2,3\r\n", "a,b,c\n 0 , 1,x\n2,3,\"y\"",
                                   "\xef\xbb\xbf"
                                   "a,b\n0,1\n2,3"}) {
        EXPECT_EQ(read_pairs(folder.write("a.csv", text)), expected) << text;
    }
}

TEST(PairReading, error_in_csv_names_the_line) {
    for (const char* const bad : {"1", "1,", ",1", "1,b", "1.5,2", "-1,2", "1,2147483648", "0 1", "a,b"}) {
        expect_bad_list(std::string("a,b\n0,1\n") + bad + "\n", "a.csv", "line 3");
    }
}

TEST(PairReading, json_can_hold_other_members) {
    const Folder folder;
    const auto read = [&](const char* text) { return read_pairs(folder.write("a.json", text)); };
    EXPECT_EQ(read(R"({"x": {"pairs": [[7,8]]}, "y": [[["pairs"]], 1.5, null], "pairs": [[0,1],[2,3]], "z": [[9]]})"),
              (Pairs{{0, 1}, {2, 3}}));
    EXPECT_TRUE(read(R"({"pairs": []})").empty());
}

TEST(PairReading, malformed_json_is_an_error) {
    for (const char* const bad :
         {R"({"pairs": [[0,1],[2]]})", R"({"pairs": [[0,1],[2,3,4]]})", R"({"pairs": [[0,1],5]})",
          R"({"pairs": [[0,1],[2,-3]]})", R"({"pairs": [[0,1],[2,3.5]]})", R"({"pairs": [[0,1],[2,2147483648]]})",
          R"({"pairs": [[0,1],[2,99999999999999999999]]})", R"({"pairs": [[0,1],["2",3]]})",
          R"({"pairs": [[0,1],[[2,3]]]})", R"({"pairs": [[0,1],null]})", R"({"pairs": [[0,1],{}]})"}) {
        expect_bad_list(bad, "a.json", "pair 1 ");
    }
    for (const char* const bad : {"{}", "[]", "[[0,1]]", "1", R"({"pairs": 1})", R"({"pairs": {}})"}) {
        expect_bad_list(bad, "a.json", "no array");
    }
    expect_bad_list("", "a.json", "byte 0");
    expect_bad_list("hello", "a.json", "byte ");
    expect_bad_list(R"({"pairs": [[0,1],)", "a.json", "byte ");
    expect_bad_list(std::string(100'000, '['), "a.json", "byte ");
}

/// Returns a .npz with one file, stored or compressed.
std::string archive_of(const std::string& name, const std::string& bytes, bool compressed = false) {
    ZipWriter archive("test");
    archive.begin(name, compressed ? ZipWriter::Method::deflate : ZipWriter::Method::store);
    archive.add(bytes);
    archive.end();
    std::ostringstream out;
    archive.write(out);
    return out.str();
}

TEST(PairReading, npz_integers_can_have_either_byte_order_and_several_sizes) {
    using std::endian;
    const Folder folder;
    const auto read = [&](const std::string& array, bool compressed = false) {
        const auto pairs = read_pairs(folder.write("a.npz", archive_of("pairs.npy", array, compressed)));
        EXPECT_EQ(read_pairs(folder.write("a.npy", array)), pairs);
        return pairs;
    };
    const Pairs expected{{0, 1}, {2, 300}};
    EXPECT_EQ(read(npy("<i4", "(2, 2)", packed(endian::little, 0, 1, 2, 300))), expected);
    EXPECT_EQ(read(npy("<i4", "(2, 2)", packed(endian::little, 0, 1, 2, 300)), true), expected);
    EXPECT_EQ(read(npy(">i4", "(2, 2)", packed(endian::big, 0, 1, 2, 300))), expected);
    EXPECT_EQ(read(npy("<u4", "(2, 2)", packed(endian::little, 0, 1, 2, 300))), expected);
    EXPECT_EQ(read(npy("<i4", "(2, 2)", packed(endian::little, 0, 2, 1, 300), true)), expected);
    EXPECT_EQ(read(npy("<i8", "(2, 2)", packed(endian::little, 0l, 1l, 2l, 300l))), expected);
    EXPECT_EQ(read(npy(">u8", "(2, 2)", packed(endian::big, 0ul, 1ul, 2ul, 300ul))), expected);
    std::string third = npy("<i4", "(2, 2)", packed(endian::little, 0, 1, 2, 300));
    third.replace(6, 4, std::string("\x03\0", 2) + third.substr(8, 2) + std::string(2, '\0'));
    EXPECT_EQ(read(third), expected) << "version 3 has a longer length";
}

TEST(PairReading, malformed_npz_is_an_error) {
    const auto expect_bad = [](const std::string& array, const std::string& what) {
        expect_bad_list(archive_of("pairs.npy", array), "a.npz", what);
        expect_bad_list(array, "a.npy", what);
    };
    const std::string two = packed(std::endian::little, 0, 1, 2, 3);
    expect_bad_list("", "a.npz", "archive");
    expect_bad_list("PK\x03\x04 and nothing else", "a.npz", "archive");
    expect_bad_list(archive_of("hits.npy", npy("<i4", "(2, 2)", two)), "a.npz", "no array 'pairs'");
    expect_bad("not an array", "not a NumPy array");
    expect_bad("\x93NUMPY", "truncated");
    expect_bad(npy("<i4", "(4,)", two), "shape");
    expect_bad(npy("<i4", "(2, 3)", two), "shape");
    expect_bad(npy("<i4", "()", two), "shape");
    expect_bad(npy("<i4", "(-2, 2)", two), "shape");
    expect_bad(npy("<i4", "(99999999999999999999, 2)", two), "shape");
    expect_bad(npy("<i4", "(1152921504606846976, 2)", two), "shape");
    expect_bad(npy("<i4", "(99999999999, 2)", two), "truncated");
    expect_bad(npy("<i4", "(3, 2)", two), "truncated");
    expect_bad(npy("<i4", "(1, 2)", two), "longer");
    expect_bad(npy("<f8", "(1, 2)", two), "integers");
    expect_bad(npy("|O", "(1, 2)", two), "integers");
    expect_bad(npy("<i4", "(2, 2)", packed(std::endian::little, 0, 1, 2, -3)), "pair 1 names no triangle");
    expect_bad(npy("<i8", "(1, 2)", packed(std::endian::little, 0l, 1l << 40)), "pair 0 names no triangle");
    std::string damaged = archive_of("pairs.npy", npy("<i4", "(2, 2)", two));
    damaged[damaged.find("NUMPY") + 75] ^= 1;
    expect_bad_list(damaged, "a.npz", "truncated or damaged");  // detected by the checksum
    std::string locked = archive_of("pairs.npy", npy("<i4", "(2, 2)", two));
    locked[6] ^= 1;
    locked[locked.find("PK\1\2") + 8] ^= 1;
    expect_bad_list(locked, "a.npz", "no array 'pairs' that can be read");
    const std::string deflated = archive_of("pairs.npy", npy("<i4", "(2, 2)", two), true);
    for (std::size_t size = 0; size < deflated.size(); ++size)
        expect_bad_list(deflated.substr(0, size), "a.npz", "archive");
}

}  // namespace
}  // namespace crumple::io::test
