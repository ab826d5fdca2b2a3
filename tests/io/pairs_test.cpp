#include <charconv>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "collisions.h"
#include "files.h"
#include "io/bytes/zip.h"

namespace crumple::io::test {
namespace {

std::string written(const Intersections& collisions, PairFormat format) {
    std::ostringstream out;
    write_pairs(out, collisions, format);
    return out.str();
}

TEST(Pairs, text_has_two_numbers_per_line) {
    EXPECT_EQ(written(example(false), PairFormat::txt), "0 2\n0 2147483647\n1 2\n");
    EXPECT_EQ(written(example(false), PairFormat::automatic), "0 2\n0 2147483647\n1 2\n");
    EXPECT_EQ(written({}, PairFormat::txt), "");
}

TEST(Pairs, text_with_contacts_appends_kind_and_points) {
    EXPECT_EQ(written(example(true), PairFormat::txt),
              "0 2 point 0.1 0.1 1\n0 2147483647 segment -2 -2 1 1e+300 1e+300 1\n"
              "1 2 area 5e-324 5e-324 1 0.3333333333333333 0.3333333333333333 1 0 0 1\n");
}

TEST(Pairs, csv_has_a_header_and_equally_many_fields_per_line) {
    EXPECT_EQ(written(example(false), PairFormat::csv), "a,b\n0,2\n0,2147483647\n1,2\n");
    std::istringstream lines(written(example(true), PairFormat::csv));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line.substr(0, 29), "a,b,kind,points,x0,y0,z0,x1,y");
    const auto fields = std::count(line.begin(), line.end(), ',');
    std::getline(lines, line);
    EXPECT_EQ(line, "0,2,point,1,0.1,0.1,1,,,,,,,,,,,,,,,");
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), fields);
    std::getline(lines, line);
    EXPECT_EQ(line, "0,2147483647,segment,2,-2,-2,1,1e+300,1e+300,1,,,,,,,,,,,,");
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), fields);
    std::getline(lines, line);
    EXPECT_TRUE(line.starts_with("1,2,area,3,")) << line;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), fields);
}

TEST(Pairs, list_written_in_blocks_has_the_rows_of_its_blocks) {
    for (const bool contacts : {false, true})
        for (const PairFormat format : {PairFormat::txt, PairFormat::csv}) {
            const Intersections one = example(contacts);
            std::ostringstream twice;
            PairWriter writer(twice, contacts, format);
            writer.add(one);
            writer.add(one);
            writer.commit();
            const std::string once = written(one, format);
            const std::size_t header = format == PairFormat::csv ? once.find('\n') + 1 : 0;
            EXPECT_EQ(twice.str(), once + once.substr(header));
        }
}

TEST(Pairs, blocks_replace_the_old_file_only_on_commit) {
    const Folder folder;
    const auto path = folder / "pairs.txt";
    std::ofstream(path) << "old";
    {
        PairWriter writer(path, false);
        writer.add(example(false));
    }
    EXPECT_EQ(bytes_of(path), "old");
    PairWriter writer(path, false);
    writer.add(example(false));
    EXPECT_THROW(writer.add(example(true)), Error) << "contacts that were not announced";
    writer.commit();
    EXPECT_EQ(bytes_of(path), written(example(false), PairFormat::txt));
    EXPECT_THROW(PairWriter(folder / "pairs.json", false), Error);
    EXPECT_THROW(PairWriter(folder / "pairs.xyz", false), Error);
}

TEST(Pairs, json_holds_pairs_contacts_and_statistics) {
    const auto json = nlohmann::json::parse(written(example(true), PairFormat::json));
    EXPECT_EQ(json["pairs"], nlohmann::json::parse("[[0,2],[0,2147483647],[1,2]]"));
    ASSERT_EQ(json["contacts"].size(), 3u);
    EXPECT_EQ(json["contacts"][1]["kind"], "segment");
    EXPECT_EQ(json["contacts"][1]["points"], nlohmann::json::parse("[[-2,-2,1],[1e300,1e300,1]]"));
    EXPECT_EQ(json["contacts"][2]["points"][0][0].get<double>(), 5e-324);
    EXPECT_EQ(json["statistics"]["pairs"], 3);
    EXPECT_EQ(json["statistics"]["backend"], "cpu");
    EXPECT_EQ(json["statistics"]["stage_milliseconds"]["sweep"], 1.5);
    const auto without = nlohmann::json::parse(written(example(false), PairFormat::json));
    EXPECT_FALSE(without.contains("contacts"));
    EXPECT_EQ(nlohmann::json::parse(written({}, PairFormat::json))["pairs"].size(), 0u);
}

/// Entry of a .npz: the header's dictionary and the array's bytes.
struct Entry {
    std::string dictionary, data;
};

Entry entry_of(const fs::path& path, const std::string& name) {
    const Source source(path);
    ZipReader archive(source, ".npz");
    if (!archive.open(name + ".npy")) return {};
    std::string bytes(source.text().size(), '\0');
    std::size_t size = 0, got = 0;
    do {
        EXPECT_TRUE(archive.read(bytes.data() + size, bytes.size() - size, got)) << "checksum";
        size += got;
    } while (got > 0);
    bytes.resize(size);
    EXPECT_NE(source.text().find(bytes), source.text().npos) << "stored as it is";
    EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t length = load<std::uint16_t>(bytes.data() + 8, std::endian::little);
    EXPECT_EQ((10 + length) % 64, 0u) << "the array is aligned";
    return {bytes.substr(10, length), bytes.substr(10 + length)};
}

template <class T>
std::string raw(const Array<T>& array) {
    return {reinterpret_cast<const char*>(array.data()), array.size() * sizeof(T)};
}

TEST(Pairs, npz_holds_the_arrays_byte_for_byte) {
    const Folder folder;
    const Intersections c = example(true);
    write_pairs(folder / "a.npz", c);
    const auto expect = [&](const char* name, const std::string& type, const std::string& shape,
                            const std::string& data) {
        const Entry entry = entry_of(folder / "a.npz", name);
        EXPECT_NE(entry.dictionary.find("'descr': '" + type + "'"), std::string::npos) << entry.dictionary;
        EXPECT_NE(entry.dictionary.find("'shape': (" + shape + ")"), std::string::npos) << entry.dictionary;
        EXPECT_EQ(entry.data, data) << name;
    };
    expect("pairs", "<i4", "3,2", raw(c.pairs));
    expect("offsets", "<i8", "4,", raw(c.offsets));
    expect("hit", "|u1", "3,", raw(c.hit));
    expect("contact_kinds", "|u1", "3,", raw(c.contacts.kinds));
    expect("contact_offsets", "<i8", "4,", raw(c.contacts.offsets));
    expect("contact_points", "<f8", "6,3", raw(c.contacts.points));
    EXPECT_EQ(entry_of(folder / "a.npz", "hit_second").dictionary, "") << "one soup has no second mesh";
}

TEST(Pairs, equal_results_give_equal_npz_files) {
    const std::string npz = written(example(true), PairFormat::npz);
    EXPECT_EQ(npz, written(example(true), PairFormat::npz));
    // Times have a resolution of 2 s, so two files written in succession can be equal although they hold the time.
    EXPECT_EQ(npz.substr(10, 4), packed(std::endian::little, std::uint32_t{33} << 16)) << "always 1980-01-01";
}

TEST(Pairs, numpy_loads_npz) {
    const auto run = [](const std::string& code) { return std::system(("python3 -c \"" + code + "\" 2>&1").c_str()); };
    if (run("import numpy") != 0) GTEST_SKIP() << "python3 has no numpy";
    const Folder folder;
    write_pairs(folder / "a.npz", example(true));
    write_pairs(folder / "empty.npz", {});
    const std::string load = "import numpy as np; z = np.load('" + (folder / "a.npz").string() + "'); ";
    EXPECT_EQ(run(load + "assert z['pairs'].dtype == np.int32 and z['pairs'].tolist() == [[0,2],[0,2147483647],[1,2]]"),
              0);
    EXPECT_EQ(run(load + "assert z['offsets'].dtype == np.int64 and z['offsets'].tolist() == [0,2,3,3]"), 0);
    EXPECT_EQ(run(load + "assert z['hit'].dtype == np.uint8 and z['hit'].tolist() == [1,1,1]"), 0);
    EXPECT_EQ(run(load + "assert z['contact_kinds'].tolist() == [1,2,3]"), 0);
    EXPECT_EQ(run(load + "assert z['contact_points'].shape == (6,3) and z['contact_points'][3,0] == 5e-324"), 0);
    EXPECT_EQ(
        run("import numpy as np; assert np.load('" + (folder / "empty.npz").string() + "')['pairs'].shape == (0,2)"),
        0);
}

TEST(Pairs, inconsistent_contacts_are_refused) {
    for (const PairFormat format : {PairFormat::txt, PairFormat::csv, PairFormat::json, PairFormat::npz}) {
        Intersections c = example(true);
        c.pairs.push_back({1, 3});
        EXPECT_EQ(error_of([&] { written(c, format); }).code, ErrorCode::invalid_argument);
        c = example(true);
        for (const std::int64_t offset : {100, 1, 0, -1}) {  // each pair has 1 to 6 points
            c.contacts.offsets[2] = offset;
            EXPECT_EQ(error_of([&] { written(c, format); }).code, ErrorCode::invalid_argument) << offset;
        }
    }
}

TEST(Pairs, failing_stream_is_an_error) {
    for (const PairFormat format : {PairFormat::txt, PairFormat::csv, PairFormat::json, PairFormat::npz}) {
        std::ofstream closed;
        EXPECT_EQ(error_of([&] { write_pairs(closed, example(true), format); }).code, ErrorCode::file);
    }
}

}  // namespace
}  // namespace crumple::io::test
