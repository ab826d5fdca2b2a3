// Compares whether features meet with the sample queries of the CCD benchmark of Wang et al. (2021): handmade
// degenerate scenes, whose coordinates are given as fractions.

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "exact/integer.h"
#include "impacts/decided_moves.h"
#include "io/files.h"

namespace crumple {
namespace {

namespace fs = std::filesystem;

/// Returns a fraction as a float64 number. Its denominator must be a power of two, and its numerator have 53 bits at
/// most.
double coordinate(const std::string& numerator, const std::string& denominator) {
    const Integer n(numerator), d(denominator);
    const auto places = [](const Integer& x) { return static_cast<int>(x == 0 ? 0 : lsb(x)); };
    const int down = places(mp::abs(n)), up = places(d);
    EXPECT_EQ(d >> up, 1) << denominator;
    const auto odd = static_cast<std::int64_t>(Integer(mp::abs(n) >> down));
    EXPECT_LT(odd, std::int64_t{1} << 53) << numerator;
    return std::ldexp(static_cast<double>(n < 0 ? -odd : odd), down - up);
}

struct Row {
    Vec3d point;
    bool meets;
};

Row read_row(const std::string& line) {
    std::array<std::string, 7> cell;
    std::size_t from = 0;
    for (std::string& c : cell) {
        const std::size_t to = std::min(line.find(',', from), line.size());
        c = line.substr(from, to - from);
        from = std::min(to + 1, line.size());
    }
    const auto number = [&](std::size_t axis) { return coordinate(cell[2 * axis], cell[2 * axis + 1]); };
    return {{number(0), number(1), number(2)}, cell[6] == "1"};
}

TEST(SampleQueries, samples_of_the_ccd_benchmark_are_all_decided_correctly) {
    const auto folder = io::test::data_folder();
    if (!folder || !fs::exists(*folder / "ccd-sample-queries")) GTEST_SKIP() << "no queries: set CRUMPLE_DATA";
    int queries = 0, hits = 0;
    ImpactCounts counts;
    for (const auto& entry : fs::recursive_directory_iterator(*folder / "ccd-sample-queries")) {
        if (entry.path().extension() != ".csv") continue;
        const std::string kind = entry.path().parent_path().filename().string();
        ASSERT_TRUE(kind == "vertex-face" || kind == "edge-edge") << entry.path();
        const Feature feature = kind == "vertex-face" ? Feature::vertex_face : Feature::edge_edge;
        std::ifstream file(entry.path());
        for (std::string line; std::getline(file, line);) {
            Move move{feature, {}};
            bool meets = false;
            for (std::size_t row = 0; row < 8; ++row) {
                ASSERT_TRUE(row == 0 || std::getline(file, line)) << entry.path();
                const Row read = read_row(line);
                (row < 4 ? move.point[row].start : move.point[row - 4].end) = read.point;
                meets = read.meets;
            }
            ++queries;
            hits += meets;
            const Impact impact = move.impact();
            EXPECT_EQ(impact.meets, meets) << entry.path() << ": " << move;
            EXPECT_EQ(decide(move, counts), impact) << entry.path() << ": " << move;
        }
    }
    EXPECT_EQ(queries, 2'500);
    EXPECT_GT(hits, 0);
    EXPECT_LT(hits, queries);
    EXPECT_LT(counts.exact, queries / 10);
}

}  // namespace
}  // namespace crumple
