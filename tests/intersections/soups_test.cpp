// Compares the rational intersection with exact results of external origin: soups with every kind of contact,
// degenerate triangles and repeated indices, at ordinary, huge and subnormal scale.

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "crumple/io.h"
#include "exact/intersection/exact_intersection.h"
#include "geometry/random_pairs.h"
#include "io/files.h"

namespace crumple {
namespace {

struct ExactResult {
    int shared, degenerate, points, strict;
};

Triangle triangle_of(const io::TriangleMesh& mesh, std::int32_t t) {
    Triangle result;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto v = mesh.triangles[3 * static_cast<std::size_t>(t) + i];
        result.vertex[i] = v;
        for (int axis = 0; axis < 3; ++axis) {
            const auto at = 3 * static_cast<std::size_t>(v) + static_cast<std::size_t>(axis);
            result.point[i][axis] =
                std::visit([&](const auto& x) { return static_cast<double>(x[at]); }, mesh.vertices);
        }
    }
    return result;
}

class Soups : public testing::TestWithParam<std::array<const char*, 2>> {};

TEST_P(Soups, decisions_and_numbers_of_points_match_ground_truth) {
    const auto folder = io::test::data_folder();
    if (!folder) GTEST_SKIP() << "no scenes: set CRUMPLE_DATA";
    const auto [soup, result_file] = GetParam();
    const io::TriangleMesh mesh = io::read_mesh(*folder / "soups" / soup);
    std::map<std::array<int, 2>, ExactResult> expected;
    std::ifstream lines(*folder / "gt" / result_file);
    std::array<int, 2> ids;
    for (ExactResult x; lines >> ids[0] >> ids[1] >> x.shared >> x.degenerate >> x.points >> x.strict;)
        expected[ids] = x;
    ASSERT_FALSE(expected.empty()) << result_file;

    std::size_t collisions = 0;
    for (std::int32_t i = 0; i < mesh.triangle_count(); ++i) {
        for (std::int32_t j = i + 1; j < mesh.triangle_count(); ++j) {
            const TrianglePair pair{triangle_of(mesh, i), triangle_of(mesh, j)};
            SCOPED_TRACE(testing::Message() << i << ' ' << j << ": " << pair);
            const RationalIntersection found = intersect_rationally(pair.a, pair.b);
            const auto exact = expected.find({i, j});
            ASSERT_EQ(found.collides, exact != expected.end());
            if (!found.collides) {
                ASSERT_FALSE(found.proper);
                continue;
            }
            ++collisions;
            ASSERT_EQ(found.shared, exact->second.shared);
            ASSERT_EQ(static_cast<int>(found.points.size()), exact->second.points);
            ASSERT_EQ(found.proper, exact->second.strict == 1);
        }
    }
    EXPECT_EQ(collisions, expected.size());
}

INSTANTIATE_TEST_SUITE_P(RationalIntersection, Soups,
                         testing::Values(std::array{"soup_degenerate.ply", "soup_degenerate.txt"},
                                         std::array{"soup_grid.ply", "soup_grid.txt"},
                                         std::array{"soup_huge32.ply", "soup_huge32.txt"},
                                         std::array{"soup_repeat.ply", "soup_repeat.txt"},
                                         std::array{"soup_tiny64.ply", "soup_tiny64.f64.txt"}));

}  // namespace
}  // namespace crumple
