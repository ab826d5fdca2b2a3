// Tests of reading poses from text and NumPy. A file has one or more configurations, each with one pose per body.

#include <sstream>

#include "files.h"

namespace crumple::io::test {
namespace {

const std::vector<std::string> two_bodies{"base", "arm"};

std::vector<Pose> read_text(const std::string& text, const std::vector<std::string>& bodies = two_bodies,
                            const std::string& name = "p.csv") {
    std::istringstream in(text);
    return read_poses(in, name, bodies);
}

void expect_refused_text(const std::string& text, const std::string& what, const std::string& name = "p.csv") {
    const Error error = error_of([&] { read_text(text, two_bodies, name); });
    EXPECT_EQ(error.code, ErrorCode::format) << error.what();
    EXPECT_TRUE(contains(error.what(), what)) << error.what();
}

Pose counted(double first) {
    Pose pose;
    for (double& number : pose.rows) number = first++;
    return pose;
}

TEST(PoseReading, rows_of_text_have_commas_or_blanks) {
    const std::vector<Pose> expected{counted(0), counted(12)};
    const std::string a = "0,1,2,3,4,5,6,7,8,9,10,11", b = "12 13 14\t15, 16 ,17,18,19,20 21 +22 2.3e1";
    EXPECT_EQ(read_text(a + "\n" + b), expected);
    EXPECT_EQ(read_text("# poses\n\nr00,r01 and so on\n" + a + "\r\n\r\n" + b + " # the last\r\n"), expected);
    EXPECT_EQ(read_text(a + ",0,0,0,1\n" + b + " 0 0 0 1\n"), expected);
    EXPECT_EQ(read_text("\xef\xbb\xbf" + a + "\n" + b), expected);
    EXPECT_TRUE(read_text("").empty());
    EXPECT_EQ(read_text("1e-400,1,2,3,4,5,6,7,8,9,10,11", {"a"})[0].rows[0], 0);
    EXPECT_EQ(read_text("0.1,1,2,3,4,5,6,7,8,9,10,11", {"a"})[0].rows[0], 0.1);
}

TEST(PoseReading, error_in_text_names_line_row_and_body) {
    const std::string row = "0,1,2,3,4,5,6,7,8,9,10,11\n";
    expect_refused_text(row + row + row + "1,2\n",
                        "p.csv, line 4: row 3 (configuration 1, body 'arm'): a pose must have 12");
    expect_refused_text(row + "0,1,2,3,4,5,6,7,8,9,10,11,12\n",
                        "row 1 (configuration 0, body 'arm'): a pose must have 12");
    expect_refused_text(row + "0,1,2,3,4,5,6,7,8,9,10,11,0,0,0,2\n", "must end with 0 0 0 1");
    for (const char* const number : {"nan", "-NaN", "inf", "1e999"})
        expect_refused_text("0,1,2," + std::string(number) + ",4,5,6,7,8,9,10,11\n",
                            "p.csv, line 1: row 0 (configuration 0, body 'base'): number 4 is not finite");
    expect_refused_text(row + "one,two\n", "p.csv, line 2: 'one' is not a number");
    expect_refused_text(row + "0x1,1,2,3,4,5,6,7,8,9,10,11", "'0x1' is not a number");
    expect_refused_text(row, "1 rows for 2 bodies: the last configuration has 1");
}

/// Returns an array of NumPy with the numbers 0, 1, ...
template <class Scalar>
std::string npy_of(const std::string& descr, const std::string& shape, std::size_t items, std::endian order,
                   const char* fortran = "False") {
    const std::string header =
        "{'descr': '" + descr + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }\n";
    std::string file = "\x93NUMPY" + std::string("\x01\x00", 2) +
                       packed(std::endian::little, static_cast<std::uint16_t>(header.size())) + header;
    for (std::size_t i = 0; i < items; ++i) file += packed(order, static_cast<Scalar>(i));
    return file;
}

TEST(PoseReading, array_shape_can_end_with_12_or_with_3_by_4) {
    const auto little = std::endian::little;
    const std::vector<Pose> expected{counted(0), counted(12)};
    for (const char* const shape : {"(2, 12)", "(1, 2, 12)", "(2, 3, 4)", "(1, 2, 3, 4)"}) {
        const std::string file = npy_of<double>("<f8", shape, 24, little);
        EXPECT_EQ(read_text(file, two_bodies, "p.npy"), expected) << shape;
    }
    EXPECT_EQ(read_text(npy_of<float>("<f4", "(2, 12)", 24, little), two_bodies, "p.npy"), expected);
    EXPECT_EQ(read_text(npy_of<double>(">f8", "(2, 12)", 24, std::endian::big), two_bodies, "p.npy"), expected);
    EXPECT_TRUE(read_text(npy_of<double>("<f8", "(0, 2, 12)", 0, little), two_bodies, "p.npy").empty());
    EXPECT_EQ(read_text(npy_of<double>("<f8", "(12,)", 12, little), {"a"}, "p.npy").size(), 1u);
}

TEST(PoseReading, malformed_arrays_are_refused) {
    const auto little = std::endian::little;
    const auto refused = [](const std::string& file, const std::string& what) {
        expect_refused_text(file, what, "p.npy");
    };
    refused("no array", "not a NumPy array");
    refused(npy_of<double>("<f8", "(24,)", 24, little), "the array's shape must end with 12");
    refused(npy_of<double>("<f8", "()", 1, little), "the array's shape must end with 12");
    refused(npy_of<double>("<f8", "(2, 4, 4)", 32, little), "row 0 (configuration 0, body 'base'): a pose of 16");
    refused(npy_of<double>("<f8", "(2, 12)", 24, little, "True"), "Fortran order");
    refused(npy_of<std::int64_t>("<i8", "(2, 12)", 24, little), "must hold float32 or float64");
    refused(npy_of<double>("<f8", "(2, 12)", 23, little), "truncated");
    refused(npy_of<double>("<f8", "(2, 12)", 25, little), "longer than its header says");
    refused(npy_of<double>("<f8", "(9223372036854775807, 9223372036854775807, 12)", 24, little), "truncated");
    refused(npy_of<double>("<f8", "(999999999999, 12)", 24, little), "truncated");
    refused(npy_of<double>("<f8", "(2, -12)", 24, little), "the array's shape must end with 12");
    refused(npy_of<double>("<f8", "(3, 12)", 36, little), "3 rows for 2 bodies");
    std::string file = npy_of<double>("<f8", "(2, 12)", 24, little);
    const std::string nan = packed(little, std::numeric_limits<double>::quiet_NaN());
    file.replace(file.size() - 16, 8, nan);
    refused(file, "p.npy: row 1 (configuration 0, body 'arm'): number 11 is not finite");
}

}  // namespace
}  // namespace crumple::io::test
