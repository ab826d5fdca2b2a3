// Tests of the codecs of lists with a table of animals: the codecs do not depend on the content of a table, and this
// one has combinations of fields that no list of results has.

#include <cmath>
#include <limits>
#include <sstream>

#include "files.h"
#include "io/lists/list_files.h"

namespace crumple::io::test {
namespace {

/// Returns a table of birds with their weight, and of fish with their food.
RowTable animals() {
    return {{"animal", "id", "food", "weight", "tame"},
            {{"bird", {{FieldType::id_of_body, 1, "bird"}, {FieldType::number, 3}, {FieldType::flag, 4, {}, false}}},
             {"fish",
              {{FieldType::id, 2, "plant"}, {FieldType::id, 1, "fish"}, {FieldType::number, 3}, {FieldType::flag, 4}}}},
            1};
}

std::string written(bool csv) {
    std::ostringstream out;
    const RowTable table = animals();
    {
        RowWriter writer(out, table, csv);
        writer.write_heading();
        writer.add(0, std::vector<ListValue>{ListId{7, 1}, 0.5, true});
        writer.add(1, std::vector<ListValue>{ListId{3}, ListId{4}, 2.0, false});
        writer.add(1, std::vector<ListValue>{ListId{3}, ListId{5}});
    }
    return out.str();
}

TEST(ListTables, text_rows_hold_only_their_fields_and_csv_rows_all_columns) {
    EXPECT_EQ(written(false), "bird 1:7 0.5\nfish 3 4 2 0\nfish 3 5\n");
    EXPECT_EQ(written(true), "animal,id,food,weight,tame\nbird,1:7,,0.5,1\nfish,4,3,2,0\nfish,5,3,,\n");
}

/// Reads a list with that table. Returns the section and the number of values of each row, or the message of the error.
std::string read(const std::string& bytes, const std::string& name) {
    std::istringstream in(bytes);
    const Source source(in, name);
    std::string text;
    const ConsumeRow take = [&](std::size_t section, std::span<const ListValue> values) -> std::string {
        text += std::to_string(section) + '/' + std::to_string(values.size()) + ' ';
        return section == 1 && std::get<ListId>(values[1]).index == 9 ? "nine is no fish" : "";
    };
    try {
        read_list(source, {animals(), take, {}, {}});
    } catch (const Error& error) {
        return error.what();
    }
    return text;
}

TEST(ListTables, rows_can_lack_their_last_field) {
    EXPECT_EQ(read("bird 1:7 0.5\nfish 3 4 2 0\n", "a.txt"), "0/2 1/4 ");
    EXPECT_EQ(read("animal,id,food,weight\nbird,7,,0.5\nfish,4,3,2,0\n", "a.csv"), "0/2 1/4 ");
}

TEST(ListTables, error_in_a_row_names_the_line) {
    EXPECT_EQ(read("bird 7\n", "a.txt"), "a.txt, line 1: `bird` must be followed by 1 ids and a number");
    EXPECT_EQ(read("\nfish 3 0:4 2 0\n", "a.txt"), "a.txt, line 2: '0:4' names no fish");
    EXPECT_EQ(read("fish 3 9 2\n", "a.txt"), "a.txt, line 1: nine is no fish");
    EXPECT_EQ(read("fish 3 4 2 1 1\n", "a.txt"), "a.txt, line 1: unexpected '1' after the last value");
    EXPECT_EQ(read("cat 3\n", "a.txt"), "a.txt, line 1: 'cat' is not bird or fish");
    EXPECT_EQ(read("bird,7,8,0.5,1\n", "a.csv"), "a.csv, line 1: '8' is in a column that this kind does not use");
    EXPECT_EQ(read("bird,7,\n", "a.csv"), "a.csv, line 1: the row has 3 columns instead of 5");
}

TEST(ListTables, csv_words_are_quoted_where_needed) {
    const RowTable table{{"name", "weight"},
                         {{"", {{FieldType::word, 0, "name"}, {FieldType::number, 1, {}, true, true}}}}};
    const std::vector<std::string> names{"a,b", "say \"x\"", " blank ", "two\nlines", "plain", "name"};
    std::ostringstream out;
    {
        RowWriter writer(out, table, true);
        writer.write_heading();
        for (const std::string& name : names)
            writer.add(0, std::vector<ListValue>{name, std::numeric_limits<double>::quiet_NaN()});
    }
    EXPECT_EQ(out.str(), "name,weight\n\"a,b\",\n\"say \"\"x\"\"\",\n\" blank \",\n\"two\nlines\",\nplain,\nname,\n");
    std::istringstream in(out.str());
    const Source source(in, "a.csv");
    std::vector<std::string> read;
    read_csv_rows(source, table, [&](std::size_t, std::span<const ListValue> values) -> std::string {
        read.emplace_back(std::get<std::string_view>(values[0]));
        return std::isnan(std::get<double>(values[1])) ? "" : "an empty cell is no number";
    });
    EXPECT_EQ(read, names);
}

TEST(ListTables, misplaced_quotes_are_errors) {
    const RowTable table{{"name"}, {{"", {{FieldType::word, 0, "name"}}}}};
    const auto error = [&](const char* bytes) {
        std::istringstream in(bytes);
        const Source source(in, "a.csv");
        return std::string(error_of([&] { read_csv_rows(source, table, [](auto, auto) { return ""; }); }).what());
    };
    EXPECT_EQ(error("a\n\"b\nc\n"), "a.csv, line 2: a quote is not closed");
    EXPECT_EQ(error("\"a\" b\n"), "a.csv, line 1: ' b' follows a word in quotes");
}

const ListArray points{"points", NumberType::float64, 3}, counts{"counts", NumberType::int64, 1, {"count"}},
    flags{"flags", NumberType::uint8};

TEST(ListTables, arrays_of_numbers_ids_and_flags_read_back) {
    const std::vector<std::array<double, 3>> xyz{{0, 0.5, -1}, {1e300, 2, 3}};
    const std::vector<std::int64_t> three{0, 7, INT32_MAX};
    const std::vector<std::uint8_t> one{1};
    const std::vector<ListMember> members{with_rows(points, std::span(xyz)), with_rows(counts, std::span(three)),
                                          with_rows(flags, std::span(one)),
                                          json_member("more", [](Sink& sink) { sink << "{\"points\": []}"; })};
    for (const char* const name : {"a.json", "a.npz"}) {
        const Folder folder;
        write_list(folder / name, {"things", {}, {}, [&] { return members; }}, PairFormat::automatic);
        const ListArray arrays[] = {points, counts, flags, {"missing"}};
        NumbersByName found;
        read_list(Source(folder / name),
                  {{}, {}, {std::begin(arrays), std::end(arrays)}, [&](const NumbersByName& all) { found = all; }});
        EXPECT_EQ(found.size(), 3u) << name;
        EXPECT_EQ(found["points"].numbers, (std::vector<double>{0, 0.5, -1, 1e300, 2, 3})) << name;
        EXPECT_EQ(found["counts"].ids, (std::vector<std::int32_t>{0, 7, INT32_MAX})) << name;
        EXPECT_EQ(found["flags"].numbers, std::vector<double>{1}) << name;
    }
}

TEST(ListTables, json_null_is_read_as_nan_where_allowed_and_infinity_elsewhere) {
    std::istringstream in(R"({"far": [null], "gaps": [null]})");
    const Source source(in, "a.json");
    ListArray gaps{"gaps", NumberType::float64};
    gaps.may_be_nan = true;
    const ListArray arrays[] = {{"far", NumberType::float64}, gaps};
    NumbersByName found = read_list_json(source, arrays);
    EXPECT_TRUE(std::isinf(found["far"].numbers.at(0)));
    EXPECT_TRUE(std::isnan(found["gaps"].numbers.at(0)));
}

TEST(ListTables, error_of_an_id_out_of_range_names_the_row) {
    const auto error = [](const char* json) {
        std::istringstream in(json);
        const Source source(in, "a.json");
        return std::string(error_of([&] { read_list_json(source, {&counts, 1}); }).what());
    };
    EXPECT_EQ(error(R"({"counts": [0, -1]})"), "a.json: row 1 of \"counts\": this is not a valid count");
    EXPECT_EQ(error(R"({"counts": [2147483648]})"), "a.json: row 0 of \"counts\": this is not a valid count");
    EXPECT_EQ(error(R"({"counts": [0, [1]]})"), "a.json: row 1 of \"counts\" is not a number");
}

}  // namespace
}  // namespace crumple::io::test
