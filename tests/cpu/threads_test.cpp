// Tests of searches for intersections on 1 to 16 threads, on scenes small enough for ThreadSanitizer: results are the
// same bytes for any number of threads.

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#ifndef CRUMPLE_STD_THREADS
#include <tbb/global_control.h>
#endif

#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;

#ifndef CRUMPLE_STD_THREADS
// Allows an arena of 16 threads on any machine.
const tbb::global_control sixteen_threads(tbb::global_control::max_allowed_parallelism, 16);
#endif

template <class T>
bool same(const Array<T>& a, const Array<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const Intersections& expected, const Intersections& found, int threads) {
    EXPECT_EQ(difference(pairs_of(expected), pairs_of(found)), "") << threads << " threads";
    EXPECT_TRUE(same(expected.offsets, found.offsets)) << threads << " threads";
    EXPECT_TRUE(same(expected.hit, found.hit)) << threads << " threads";
    EXPECT_TRUE(same(expected.hit_second, found.hit_second)) << threads << " threads";
    EXPECT_TRUE(same(expected.contacts.kinds, found.contacts.kinds)) << threads << " threads";
    EXPECT_TRUE(same(expected.contacts.offsets, found.contacts.offsets)) << threads << " threads";
    EXPECT_TRUE(same(expected.contacts.points, found.contacts.points)) << threads << " threads";
}

TEST(Threads, one_soup_gives_the_same_bytes_on_1_2_5_and_16_threads) {
    auto sheet = test::wavy_sheet(70);
    for (std::size_t t = 0; t < sheet.triangles.size(); ++t) sheet.groups.push_back(static_cast<std::int32_t>(t % 3));
    IntersectionQuery query;
    query.output = Output::contacts;
    query.filter.groups = PairScope::between;
    Detector one({.threads = 1, .leaf_size = 500});
    const Intersections expected = one.find(sheet.view(), query);
    ASSERT_GT(expected.pairs.size(), 100u);
    for (const int threads : {2, 5, 16}) {
        Detector detector({.threads = threads, .leaf_size = 500});
        for (int frame = 0; frame < 2; ++frame) expect_same(expected, detector.find(sheet.view(), query), threads);
        EXPECT_TRUE(detector.any(sheet.view(), query));
    }
}

TEST(Threads, two_meshes_give_the_same_bytes_on_1_2_and_16_threads) {
    const auto a = test::wavy_sheet(40), b = test::wavy_sheet(50, 0.4);
    Detector one({.threads = 1, .leaf_size = 300});
    const Intersections expected = one.find({a.view(), b.view()});
    ASSERT_GT(expected.pairs.size(), 100u);
    for (const int threads : {2, 16}) {
        Detector detector({.threads = threads, .leaf_size = 300});
        expect_same(expected, detector.find({a.view(), b.view()}), threads);
    }
}

// One leaf with so much work that its sweep is split into tiles, which several threads run: needles along the sweep
// direction, few of which intersect.
TEST(Threads, one_large_leaf_gives_the_same_bytes_on_1_2_and_8_threads) {
    test::Soup<float> soup;
    std::mt19937 engine(3);
    const auto number = [&] { return static_cast<float>(static_cast<double>(engine()) * 0x1p-32); };
    for (std::int32_t t = 0; t < 5000; ++t) {
        const float x = 20 * number(), y = number(), z = number();
        soup.vertices.push_back({x, y, z});
        soup.vertices.push_back({x + 12, y + 0.002f, z});
        soup.vertices.push_back({x + 12, y, z + 0.002f});
        soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    Detector one({.threads = 1, .clusters = 1, .leaf_size = 100000});
    const Intersections expected = one.find(soup.view());
    ASSERT_GT(expected.statistics.interval_tests, 5'000'000) << "enough for tiles";
    for (const int threads : {2, 8}) {
        Detector detector({.threads = threads, .clusters = 1, .leaf_size = 100000});
        expect_same(expected, detector.find(soup.view()), threads);
    }
}

}  // namespace
}  // namespace crumple
