// Tests of what detectors guarantee: sorted results, ownership of results, independence of earlier calls.

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <thread>

#include "soups.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif
#include <cfenv>

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;

TEST(Detector, pairs_are_sorted_and_agree_with_offsets_and_hit_flags) {
    const auto soup = test::random_soup(2000, 0.1);
    Detector detector;
    const Intersections& c = detector.find(soup.view());
    ASSERT_GT(c.pairs.size(), 100u);
    EXPECT_TRUE(std::is_sorted(c.pairs.begin(), c.pairs.end()));
    ASSERT_EQ(c.offsets.size(), 2001u);
    std::vector<std::uint8_t> hit(2000, 0);
    for (std::size_t i = 0; i < 2000; ++i)
        for (auto k = c.offsets[i]; k < c.offsets[i + 1]; ++k) {
            EXPECT_EQ(c.pairs[static_cast<std::size_t>(k)].a, static_cast<std::int32_t>(i));
            EXPECT_LT(c.pairs[static_cast<std::size_t>(k)].a, c.pairs[static_cast<std::size_t>(k)].b);
            hit[i] = hit[static_cast<std::size_t>(c.pairs[static_cast<std::size_t>(k)].b)] = 1;
        }
    EXPECT_EQ(c.offsets[2000], static_cast<std::int64_t>(c.pairs.size()));
    EXPECT_EQ(hit, std::vector<std::uint8_t>(c.hit.begin(), c.hit.end()));
    EXPECT_TRUE(c.hit_second.empty());
    EXPECT_TRUE(c.contacts.kinds.empty()) << "not asked for";
    EXPECT_EQ(c.statistics.pairs, static_cast<std::int64_t>(c.pairs.size()));
}

TEST(Detector, copied_result_outlives_the_next_call) {
    const auto soup = test::random_soup(500, 0.2);
    Detector detector;
    const Intersections copy = detector.find(soup.view());
    const std::vector<Pair> before = pairs_of(copy);
    detector.find(test::random_soup(700, 0.3, 9).view());
    EXPECT_EQ(difference(before, pairs_of(copy)), "");
}

TEST(Detector, taken_result_outlives_the_detector_and_storage_is_reused) {
    const auto soup = test::random_soup(500, 0.2), other = test::random_soup(700, 0.3, 9);
    std::vector<Pair> before;
    Intersections taken;
    {
        Detector detector;
        before = pairs_of(detector.find(soup.view()));
        taken = detector.take_result<Intersections>();
        const auto expected = pairs_of(detector.find(other.view()));
        const Pair* storage = detector.find(other.view()).pairs.data();
        Intersections second = detector.take_result<Intersections>();
        EXPECT_EQ(second.pairs.data(), storage) << "nothing is copied";
        EXPECT_EQ(difference(expected, pairs_of(second)), "");
        EXPECT_TRUE(detector.take_result(std::move(second)).pairs.empty()) << "the detector's own result is empty";
        EXPECT_TRUE(detector.take_result(detector.take_result<Intersections>()).pairs.empty())
            << "a spare result's content is dropped";
        EXPECT_EQ(detector.find(other.view()).pairs.data(), storage) << "spare storage is used";
    }
    EXPECT_EQ(difference(before, pairs_of(taken)), "");
}

TEST(Detector, two_results_swapped_in_turn_reuse_their_pair_arrays) {
    const auto soup = test::random_soup(500, 0.2);
    Detector detector;
    const auto expected = pairs_of(detector.find(soup.view()));
    std::array<Intersections, 2> results;
    std::set<const Pair*> storage;
    for (std::size_t frame = 0; frame < 6; ++frame) {
        Intersections& result = results[frame % 2];
        detector.swap_result(result);
        EXPECT_EQ(result.statistics.pairs, frame == 0 ? static_cast<std::int64_t>(expected.size()) : 0);
        detector.find(soup.view());
        detector.swap_result(result);
        EXPECT_EQ(difference(expected, pairs_of(result)), "");
        EXPECT_EQ(result.statistics.pairs, static_cast<std::int64_t>(expected.size()));
        if (frame >= 2) storage.insert(result.pairs.data());
    }
    EXPECT_EQ(storage.size(), 2U) << "nothing is allocated";
}

TEST(Detector, taken_results_do_not_count_towards_the_memory_limit) {
    const auto soup = test::random_soup(3000, 0.1);
    const auto peak = Detector().find(soup.view()).statistics.peak_memory_bytes;
    Detector limited({.memory_limit = peak});
    std::vector<Intersections> held;
    std::int64_t held_bytes = 0;
    while (held_bytes <= peak) {  // at the end, the taken results alone exceed the limit
        limited.find(soup.view());
        held.push_back(limited.take_result(held.empty() ? Intersections{} : held[0]));
        held_bytes += static_cast<std::int64_t>(held.back().offsets.size() * sizeof(std::int64_t));
    }
    for (const Intersections& result : held) EXPECT_EQ(difference(pairs_of(held[0]), pairs_of(result)), "");
}

TEST(Detector, reused_detector_matches_a_new_one_for_changing_topology) {
    Detector warm;
    for (const int count : {1000, 10, 3000, 0, 2, 1500}) {
        const auto soup = test::random_soup(count, 0.08, static_cast<unsigned>(count) + 1);
        Detector cold;
        const auto expected = pairs_of(cold.find(soup.view()));
        EXPECT_EQ(difference(expected, pairs_of(warm.find(soup.view()))), "") << count << " triangles";
    }
}

TEST(Detector, detectors_on_several_threads_give_the_same_pairs) {
    const auto soup = test::random_soup(3000, 0.06);
    Detector detector;
    const auto expected = pairs_of(detector.find(soup.view()));
    std::vector<std::string> results(4);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < results.size(); ++i)
        threads.emplace_back([&, i] {
            Detector own({.threads = 2});
            for (int repeat = 0; repeat < 3; ++repeat)
                results[i] += difference(expected, pairs_of(own.find(soup.view())));
        });
    for (std::thread& thread : threads) thread.join();
    for (const std::string& result : results) EXPECT_EQ(result, "");
}

TEST(Detector, any_reports_whether_anything_collides) {
    for (const Backend backend : {Backend::reference, Backend::cpu}) {
        Detector detector({.backend = backend});
        EXPECT_TRUE(detector.any(test::random_soup(300, 0.3).view()));
        EXPECT_FALSE(detector.any(test::random_soup(50, 1e-4).view()));
        const auto a = test::random_soup(100, 0.3), b = test::random_soup(100, 0.3, 2);
        EXPECT_TRUE(detector.any({a.view(), b.view()}));
        const std::vector<std::int32_t> one_group(100, 7);
        MeshView grouped = a.view();
        grouped.groups = one_group;
        const IntersectionQuery none{.filter = {.groups = PairScope::between}};
        EXPECT_FALSE(detector.any(grouped, none)) << "one group, so nothing lies between groups";
    }
}

TEST(Detector, detector_made_by_move_gives_the_same_pairs) {
    const auto soup = test::random_soup(300, 0.2);
    Detector first;
    const auto expected = pairs_of(first.find(soup.view()));
    Detector second = std::move(first);
    EXPECT_EQ(difference(expected, pairs_of(second.find(soup.view()))), "");
}

// Results must not depend on the caller's rounding mode or flush-to-zero setting, and a call must leave both unchanged.
TEST(Detector, pairs_ignore_and_calls_preserve_rounding_mode_and_flush_to_zero) {
    auto soup = test::random_soup(400, 0.2);
    for (auto& vertex : soup.vertices)
        for (float& value : vertex) value *= 0x1p-130f;  // many become subnormal
    Detector detector({.threads = 2});
    const auto expected = pairs_of(detector.find(soup.view()));
    ASSERT_GT(expected.size(), 10u);
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO, FE_TONEAREST}) {
        std::fesetround(mode);
#if defined(__SSE2__)
        const unsigned before = _mm_getcsr();
        _mm_setcsr(before | 0x8040u);  // flush to zero, denormals are zero
#endif
        const auto found = pairs_of(detector.find(soup.view()));
        Detector fresh({.threads = 2});
        const auto found_fresh = pairs_of(fresh.find(soup.view()));
        EXPECT_EQ(std::fegetround(), mode);
#if defined(__SSE2__)
        EXPECT_EQ(_mm_getcsr() & 0x8040u, 0x8040u);
        _mm_setcsr(before);
#endif
        std::fesetround(FE_TONEAREST);
        EXPECT_EQ(difference(expected, found), "") << "mode " << mode;
        EXPECT_EQ(difference(expected, found_fresh), "") << "mode " << mode;
    }
}

}  // namespace
}  // namespace crumple
