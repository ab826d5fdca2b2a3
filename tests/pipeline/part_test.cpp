// Public parts: independent, complete, nothing twice.

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "error_of.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::error_of;
using test::pairs_of;

TEST(Part, the_union_of_the_parts_is_the_whole_answer) {
    const auto soup = test::random_soup(1500, 0.1);
    const auto other = test::random_soup(800, 0.1, 4);
    Detector detector;
    const auto whole = pairs_of(detector.find_self(soup.view()));
    const auto whole_between = pairs_of(detector.find_between(soup.view(), other.view()));
    for (const int count : {1, 2, 3, 8, 33, 64}) {
        std::vector<Pair> all, all_between;
        for (const Part& part : detector.partition(soup.view(), count)) {
            Detector elsewhere({.threads = 1});
            for (const Pair& pair : elsewhere.find_self(soup.view(), part).pairs) all.push_back(pair);
        }
        for (const Part& part : detector.partition(soup.view(), other.view(), count)) {
            Detector elsewhere({.threads = 1});
            for (const Pair& pair : elsewhere.find_between(soup.view(), other.view(), part).pairs)
                all_between.push_back(pair);
        }
        std::sort(all.begin(), all.end());
        std::sort(all_between.begin(), all_between.end());
        EXPECT_EQ(difference(whole, all), "") << count << " parts";
        EXPECT_EQ(difference(whole_between, all_between), "") << count << " parts";
    }
}

TEST(Part, both_triangles_of_a_pair_are_members_of_the_part_that_answers_it) {
    const auto soup = test::wavy_sheet(40);
    Detector detector;
    ASSERT_GT(detector.find_self(soup.view()).pairs.size(), 50u);
    for (const Part& part : detector.partition(soup.view(), 7)) {
        const auto is_member = [&](std::int32_t t) {
            return std::binary_search(part.triangles.begin(), part.triangles.end(), t);
        };
        for (const Pair& pair : detector.find_self(soup.view(), part).pairs) {
            EXPECT_TRUE(is_member(pair.a)) << pair.a << " in part " << part.index;
            EXPECT_TRUE(is_member(pair.b)) << pair.b << " in part " << part.index;
        }
    }
}

TEST(Part, a_part_without_its_lists_is_answered_from_its_centres) {
    const auto soup = test::random_soup(700, 0.15), other = test::random_soup(300, 0.15, 4);
    Detector detector;
    for (Part& part : detector.partition(soup.view(), other.view(), 5)) {
        const auto listed = pairs_of(detector.find_between(soup.view(), other.view(), part));
        part.triangles.clear();
        part.triangles_second.clear();
        EXPECT_EQ(pairs_of(detector.find_between(soup.view(), other.view(), part)), listed);
    }
}

TEST(Part, only_pairs_of_listed_triangles_are_found) {
    const auto soup = test::random_soup(400, 0.3);
    Detector detector;
    Part part = detector.partition(soup.view(), 1)[0];
    std::erase_if(part.triangles, [](std::int32_t t) { return t % 3 == 0; });
    auto expected = pairs_of(detector.find_self(soup.view()));
    std::erase_if(expected, [](const Pair& pair) { return pair.a % 3 == 0 || pair.b % 3 == 0; });
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(pairs_of(detector.find_self(soup.view(), part)), expected);
    EXPECT_EQ(pairs_of(Detector({.backend = Backend::reference}).find_self(soup.view(), part)), expected);
}

TEST(Part, parts_of_other_meshes_are_refused) {
    const auto small = test::random_soup(10, 0.3), large = test::random_soup(20, 0.3);
    Detector detector;
    const Part part = detector.partition(large.view(), 1)[0];
    const Part pair = detector.partition(large.view(), large.view(), 1)[0];
    const auto error = error_of([&] { detector.find_self(small.view(), part); });
    EXPECT_EQ(error.code, ErrorCode::invalid_argument);
    EXPECT_NE(std::string(error.what()).find("the part names triangle 10 of 10"), std::string::npos) << error.what();
    EXPECT_EQ(error_of([&] { detector.find_self(large.view(), pair); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { detector.find_between(large.view(), small.view(), pair); }).code,
              ErrorCode::invalid_argument);
}

// Centres are found in float32, where the largest number rounds up.
TEST(Part, a_scene_as_large_as_numbers_are_has_parts) {
    constexpr double most = std::numeric_limits<double>::max();
    test::Soup<double> soup;
    soup.vertices = {{-most, most, -most}, {-most, most, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    soup.triangles = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {2, 3, 4}};
    Detector detector;
    const auto whole = pairs_of(detector.find_self(soup.view(), {.weld = true}));
    for (const int count : {1, 2, 4}) {
        std::vector<Pair> all;
        for (const Part& part : detector.partition(soup.view(), count)) {
            for (const Pair& pair : detector.find_self(soup.view(), part, {.weld = true}).pairs) all.push_back(pair);
        }
        std::sort(all.begin(), all.end());
        EXPECT_EQ(difference(whole, all), "") << count << " parts";
    }
}

TEST(Part, parts_overlap_little) {
    const auto soup = test::wavy_sheet(100);
    Detector detector;
    std::size_t members = 0;
    for (const Part& part : detector.partition(soup.view(), 8)) members += part.triangles.size();
    EXPECT_GE(members, soup.triangles.size());
    EXPECT_LT(members, soup.triangles.size() * 3 / 2);
}

}  // namespace
}  // namespace crumple
