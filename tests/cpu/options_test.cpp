// Tests that options change the cost, never the result.

#include <gtest/gtest.h>

#ifndef CRUMPLE_STD_THREADS
#include <tbb/global_control.h>
#endif

#include "soups.h"

namespace crumple {
namespace {

#ifndef CRUMPLE_STD_THREADS
// Allows an arena of 16 threads on any machine.
const tbb::global_control sixteen_threads(tbb::global_control::max_allowed_parallelism, 16);
#endif

using test::difference;
using test::pairs_of;

TEST(Options, clusters_leaves_and_threads_do_not_change_the_result) {
    const auto sheet = test::wavy_sheet(60);
    Detector plain({.clusters = 1, .leaf_size = 1000000});
    const Intersections expected = plain.find(sheet.view());
    ASSERT_GT(expected.pairs.size(), 100u);
    for (const int clusters : {0, 1, 2, 3, 7, 16, 31, 64})
        for (const int leaf_size : {3, 40, 500, 100000})
            for (const int threads : {1, 2, 5, 16}) {
                Detector detector({.threads = threads, .clusters = clusters, .leaf_size = leaf_size});
                for (int frame = 0; frame < 2; ++frame) {  // a first call, and a warm-started one
                    const Intersections& found = detector.find(sheet.view());
                    EXPECT_EQ(difference(pairs_of(expected), pairs_of(found)), "")
                        << clusters << " clusters, leaves of " << leaf_size << ", " << threads << " threads";
                    EXPECT_TRUE(std::equal(found.offsets.begin(), found.offsets.end(), expected.offsets.begin()));
                    EXPECT_TRUE(std::equal(found.hit.begin(), found.hit.end(), expected.hit.begin()));
                    if (clusters > 1) {
                        EXPECT_EQ(found.statistics.clusters, clusters);
                    }
                }
            }
}

TEST(Options, warm_detector_uses_as_many_clusters_as_a_new_one) {
    const auto small = test::wavy_sheet(20), large = test::wavy_sheet(60);
    const Options options{.leaf_size = 1200};  // `small` fits into one leaf, `large` needs several
    const auto clusters = Detector(options).find(large.view()).statistics.clusters;
    ASSERT_GT(clusters, 1);
    Detector detector(options);
    EXPECT_EQ(detector.find(small.view()).statistics.clusters, 1);
    EXPECT_EQ(detector.find(large.view()).statistics.clusters, clusters);
    EXPECT_EQ(detector.find(small.view()).statistics.clusters, 1);
    EXPECT_EQ(detector.find(large.view()).statistics.clusters, clusters);
}

TEST(Options, fuzziness_and_iterations_do_not_change_the_result) {
    const auto soup = test::random_soup(4000, 0.08);
    Detector plain;
    const Intersections& expected = plain.find(soup.view());
    ASSERT_GT(expected.pairs.size(), 100u);
    for (const double fuzziness : {1.01, 1.5, 2.0, 5.0, 100.0})
        for (const int iterations : {0, 1, 20}) {
            Detector detector(
                {.clusters = 12,
                 .leaf_size = 100,
                 .fuzzy_c_means = {
                     .fuzziness = fuzziness, .max_iterations = iterations, .first_iterations = iterations}});
            for (int frame = 0; frame < 3; ++frame) {
                const Intersections& found = detector.find(soup.view());
                EXPECT_EQ(difference(pairs_of(expected), pairs_of(found)), "")
                    << "t = " << fuzziness << ", " << iterations << " iterations, frame " << frame;
                EXPECT_TRUE(std::equal(found.offsets.begin(), found.offsets.end(), expected.offsets.begin()));
                EXPECT_TRUE(std::equal(found.hit.begin(), found.hit.end(), expected.hit.begin()));
            }
        }
}

TEST(Options, sheet_of_80000_triangles_has_more_leaves_than_clusters) {
    const auto sheet = test::wavy_sheet(200);  // 80,000 triangles
    Detector detector;
    const Statistics& statistics = detector.find(sheet.view()).statistics;
    EXPECT_EQ(statistics.clusters, 8);
    EXPECT_GT(statistics.leaves, statistics.clusters);
    EXPECT_LT(statistics.members, 2 * statistics.triangles);
}

}  // namespace
}  // namespace crumple
