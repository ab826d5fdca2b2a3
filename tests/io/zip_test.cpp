// Tests of zip archives as other programs write them: any mixture of ZIP64 fields, other bytes before and after the
// archive, and damage. Also tests of reading the mesh in a zip archive.

#include <zlib.h>

#include "3mf_file.h"
#include "collisions.h"
#include "files.h"
#include "io/bytes/npz.h"
#include "scenes.h"

namespace crumple::io::test {
namespace {

constexpr auto little = std::endian::little;

/// Set of numbers that an archive stores in ZIP64 fields. Their usual fields then have all bits set.
enum Large : unsigned {
    list_size = 1,
    list_compressed = 2,
    list_offset = 4,
    local_sizes = 8,
    end_offset = 16,
    end_counts = 32,
    descriptor = 64,  ///< sizes are stored after the entry, and are 0 before it
    all = 127
};

struct Archive {
    unsigned large = 0;
    bool deflated = true;
    std::string before = "", after = "";
    std::uint16_t flags = 0, method = 0;  ///< added to the usual flags; used instead of the usual method, if not 0

    std::string bytes(const std::vector<std::pair<std::string, std::string>>& entries) const {
        std::string text, list;
        for (const auto& [name, content] : entries) add(text, list, name, content);
        const std::uint64_t begin = text.size(), count = entries.size();
        const std::uint64_t zip64_at = begin + list.size();
        std::string end;
        if (large & (end_offset | end_counts)) {
            end += "PK\6\6" + packed(little, std::uint64_t{44}, std::uint16_t{45}, std::uint16_t{45}, 0, 0, count,
                                     count, std::uint64_t{list.size()}, begin);
            end += "PK\6\7" + packed(little, 0, zip64_at, 1);
        }
        const auto short_count = static_cast<std::uint16_t>(large & end_counts ? UINT16_MAX : count);
        end += "PK\5\6" + packed(little, std::uint16_t{0}, std::uint16_t{0}, short_count, short_count,
                                 number(large & end_counts, list.size()), number(large & end_offset, begin),
                                 static_cast<std::uint16_t>(after.size()));
        return before + text + list + end + after;
    }

   private:
    static std::uint32_t number(unsigned is_large, std::uint64_t value) {
        return is_large ? UINT32_MAX : static_cast<std::uint32_t>(value);
    }
    static std::string extra_field(const std::string& values) {
        // Another field precedes the field of ZIP64, as in archives of many programs.
        const std::string other = "UT" + packed(little, std::uint16_t{1}) + "x";
        if (values.empty()) return other;
        return other + packed(little, std::uint16_t{1}, static_cast<std::uint16_t>(values.size())) + values;
    }
    static std::string compress(const std::string& content) {
        z_stream stream{};
        deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
        std::string result(deflateBound(&stream, content.size()), '\0');
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
        stream.avail_in = static_cast<uInt>(content.size());
        stream.next_out = reinterpret_cast<Bytef*>(result.data());
        stream.avail_out = static_cast<uInt>(result.size());
        deflate(&stream, Z_FINISH);
        result.resize(stream.total_out);
        deflateEnd(&stream);
        return result;
    }

    void add(std::string& text, std::string& list, const std::string& name, const std::string& content) const {
        const std::string compressed = deflated ? compress(content) : content;
        const std::uint64_t size = content.size(), small = compressed.size(), offset = text.size();
        const auto checksum = static_cast<std::uint32_t>(
            crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(size)));
        const std::uint16_t how = method ? method : deflated ? 8 : 0;
        const auto bits = static_cast<std::uint16_t>(flags | (large & descriptor ? 8 : 0));
        const auto name_size = static_cast<std::uint16_t>(name.size());

        const bool later = large & descriptor;
        const std::string local_extra = extra_field(large & local_sizes ? packed(little, size, small) : "");
        text += "PK\3\4" +
                packed(little, std::uint16_t{45}, bits, how, 0, later ? 0u : checksum,
                       later ? 0u : number(large & local_sizes, small), later ? 0u : number(large & local_sizes, size),
                       name_size, static_cast<std::uint16_t>(local_extra.size())) +
                name + local_extra + compressed;
        if (later) text += "PK\7\10" + packed(little, checksum, small, size);

        std::string values;
        if (large & list_size) values += packed(little, size);
        if (large & list_compressed) values += packed(little, small);
        if (large & list_offset) values += packed(little, offset);
        const std::string extra = extra_field(values);
        list += "PK\1\2" +
                packed(little, std::uint16_t{45}, std::uint16_t{45}, bits, how, 0, checksum,
                       number(large & list_compressed, small), number(large & list_size, size), name_size,
                       static_cast<std::uint16_t>(extra.size()), std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0},
                       0, number(large & list_offset, offset)) +
                name + extra;
    }
};

using crumple::test::model_around;
using crumple::test::relationships;
using crumple::test::tetrahedron;

std::vector<std::pair<std::string, std::string>> parts_of_3mf() {
    return {{"_rels/.rels", relationships},
            {"3D/3dmodel.model", model_around("<resources><object id=\"1\">" + tetrahedron +
                                              "</object></resources><build><item objectid=\"1\"/></build>")}};
}

TEST(Zip, any_mixture_of_numbers_can_be_in_zip64_fields) {
    const Folder folder;
    const std::vector<std::pair<std::string, std::string>> arrays{
        {"pairs.npy", npy_header("<i4", "2, 2") + packed(little, 1, 2, 3, 4)}};
    for (unsigned large = 0; large <= all; ++large) {
        for (const bool deflated : {false, true}) {
            SCOPED_TRACE(std::to_string(large) + (deflated ? " deflated" : " stored"));
            for (const char* const before : {"", "#!/bin/unpack\n"}) {
                const Archive archive{.large = large, .deflated = deflated, .before = before, .after = before};
                if (*before == 0) {
                    const TriangleMesh mesh = read_bytes(archive.bytes(parts_of_3mf()), "a.3mf");
                    EXPECT_EQ(mesh.triangle_count(), 4);
                }
                EXPECT_EQ(read_pairs(folder.write("a.npz", archive.bytes(arrays))),
                          (std::vector<Pair>{{1, 2}, {3, 4}}));
            }
        }
    }
}

TEST(Zip, truncation_is_an_error_and_no_damaged_byte_changes_the_mesh_unnoticed) {
    for (const unsigned large : {0u, unsigned{all}}) {
        const std::string whole = Archive{.large = large}.bytes(parts_of_3mf());
        const TriangleMesh mesh = read_bytes(whole, "a.3mf");
        for (std::size_t size = 1; size < whole.size(); size += 3)
            EXPECT_EQ(error_of([&] { read_bytes(whole.substr(0, size), "a.3mf"); }).code, ErrorCode::format) << size;
        for (std::size_t i = 0; i < whole.size(); ++i) {
            std::string damaged = whole;
            damaged[i] = static_cast<char>(damaged[i] ^ 0x81);
            try {
                expect_same(read_bytes(damaged, "a.3mf"), mesh);  // if the damaged byte is not needed
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::format) << error.what();
            }
        }
    }
}

TEST(Zip, error_states_possible_reasons_why_an_entry_cannot_be_read) {
    const auto expect_error = [](const Archive& archive, const std::string& what) {
        const Error error = error_of([&] { read_bytes(archive.bytes(parts_of_3mf()), "a.3mf"); });
        EXPECT_EQ(error.code, ErrorCode::format);
        EXPECT_TRUE(contains(error.what(), "a.3mf") && contains(error.what(), what)) << error.what();
    };
    expect_error({.flags = 1}, "missing, encrypted, or compressed in a way that is not supported");
    expect_error({.method = 14}, "missing, encrypted, or compressed in a way that is not supported");
    const Error error = error_of([] { read_bytes(std::string("PK\3\4") + std::string(40, 'x'), "a.3mf"); });
    EXPECT_TRUE(contains(error.what(), "a.3mf: this is not a 3MF archive")) << error.what();
}

TEST(Zip, zip_with_exactly_one_mesh_is_read_and_others_are_refused) {
    const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    const auto zip = [](const std::vector<std::pair<std::string, std::string>>& entries) {
        return Archive().bytes(entries);
    };
    EXPECT_EQ(
        read_bytes(zip({{"readme.txt", "?"}, {"parts/", ""}, {"parts/A.OFF", off}, {"__MACOSX/parts/._A.OFF", "?"}}),
                   "a.zip")
            .triangle_count(),
        1);
    const auto expect_error = [](const std::string& bytes, const std::string& what) {
        const Error error = error_of([&] { read_bytes(bytes, "a.zip"); });
        EXPECT_EQ(error.code, ErrorCode::format);
        EXPECT_TRUE(contains(error.what(), "a.zip") && contains(error.what(), what)) << error.what();
    };
    {
        const crumple::test::GltfScene scene = crumple::test::robot_scene();
        const Folder folder;
        folder.write("a.bin", scene.bytes);
        EXPECT_EQ(read_world(folder.write("a.gltf", scene.gltf("a.bin"))).bodies.size(), 4u);
        const fs::path path = folder.write("a.zip", zip({{"a.gltf", scene.gltf("a.bin")}}));
        EXPECT_TRUE(contains(error_of([&] { read_world(path); }).what(), "a.bin")) << "which is not in the archive";
    }
    expect_error(zip({{"a.off", off}, {"b.stl", ""}}), "holds 2 meshes, 'a.off' the first; unpack it");
    expect_error(zip({{"readme.txt", off}}), "this is a zip archive but not a 3MF file, and it holds no mesh");
    expect_error(zip({{"a.off", "OFF\n1 0 0\n0 x 0\n"}}), "a.zip/a.off, line 3: 'x' is not a finite number");
    const char* const unread = "'a.off' is damaged, encrypted, compressed in a way that is not supported, or too large";
    for (const Archive& archive : {Archive{.flags = 1}, Archive{.method = 14}})
        expect_error(archive.bytes({{"a.off", off}}), unread);
    std::string damaged = Archive{.deflated = false}.bytes({{"a.off", off}});
    damaged[damaged.find("3 0 1 2")] = '4';
    expect_error(damaged, unread);
}

TEST(Contents, error_identifies_git_lfs_pointers_and_utf_16_text) {
    expect_bad("version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 5\n", "a.stl", Element::byte, 0,
               "this is a pointer to a file that Git LFS keeps elsewhere; `git lfs pull` downloads the file");
    const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for (const bool big : {false, true}) {
        std::string wide;
        for (const char c : off) wide += big ? std::string{'\0', c} : std::string{c, '\0'};
        for (const char* const mark : {"", big ? "\xfe\xff" : "\xff\xfe"})
            expect_bad(mark + wide, "a.off", Element::byte, 0, "this is text in UTF-16; save it as UTF-8");
    }
    const Error error = error_of([] { read_bytes("\x89PNG\r\n", "a"); });
    EXPECT_TRUE(contains(error.what(), "that of PLY, OBJ, STL, OFF, glTF or 3MF")) << error.what();
    EXPECT_EQ(read_bytes("\xff\xfe" + std::string(82, '\0'), "a.stl").triangle_count(), 0) << "a binary STL's title";
}

}  // namespace
}  // namespace crumple::io::test
