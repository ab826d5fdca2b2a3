// Tests that the lists of pairs of several workers (threads) are sorted into one, whatever the pairs' indices, and
// however they are distributed over buckets (ranges of first indices).

#include "backends/cpu/stages/sort_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace crumple::cpu {
namespace {

/// Numbers of possible first and second indices, the least second index (`before`), and a range of first indices,
/// [low, high), in which seven of eight pairs lie.
struct Indices {
    std::int32_t firsts, seconds, before;
    std::int32_t low, high;
};

class SortedPairs : public testing::TestWithParam<int> {
   protected:
    /// Sorts `count` random pairs with indices as `of` describes, in lists of several workers.
    void expect_sorted(const Indices& of, std::size_t count, bool low_memory) {
        std::mt19937 random(7);
        const auto number = [&](std::int32_t low, std::int32_t high) {
            return std::uniform_int_distribution<std::int32_t>(low, high - 1)(random);
        };
        std::set<std::pair<std::int32_t, std::int32_t>> expected;
        for (int i = 0; expected.size() < count; ++i)
            expected.insert({i % 8 ? number(of.low, of.high) : number(0, of.firsts),
                             i % 5 ? number(0, of.seconds) : number(0, std::min(of.seconds, 300))});
        std::vector<Pair> pairs;
        for (const auto& [a, b] : expected) pairs.push_back({a, b + of.before});
        std::shuffle(pairs.begin(), pairs.end(), random);

        Options options;
        options.threads = GetParam();
        Cancellation cancellation;
        Workers workers(options, cancellation);
        std::vector<Array<Pair>> lists;
        std::vector<const Array<Pair>*> found;
        for (int w = 0; w < workers.workers(); ++w) lists.emplace_back(nullptr);
        for (std::size_t i = 0; i < pairs.size(); ++i) lists[i * i % 7 % lists.size()].push_back(pairs[i]);
        for (const auto& list : lists) found.push_back(&list);
        PairSorting scratch(nullptr);
        Array<Pair> sorted(nullptr);
        Array<std::int64_t> offsets(nullptr);
        std::size_t seen = 0;
        workers.run([&] {
            sort_pairs(workers, found, {of.firsts, of.seconds, of.before, low_memory}, scratch, sorted, offsets,
                       [&](std::span<const std::span<const Pair>> pieces) {
                           for (const auto& piece : pieces) seen += piece.size();
                       });
        });
        EXPECT_EQ(seen, count);
        ASSERT_EQ(sorted.size(), count);
        ASSERT_EQ(offsets.size(), static_cast<std::size_t>(of.firsts) + 1);
        std::size_t i = 0;
        for (const auto& [a, b] : expected) {
            ASSERT_EQ(sorted[i], (Pair{a, b})) << i;
            ASSERT_LE(offsets[static_cast<std::size_t>(a)], static_cast<std::int64_t>(i));
            ASSERT_GT(offsets[static_cast<std::size_t>(a) + 1], static_cast<std::int64_t>(i));
            ++i;
        }
        EXPECT_EQ(offsets.front(), 0);
        EXPECT_EQ(offsets.back(), static_cast<std::int64_t>(count));
    }
};
INSTANTIATE_TEST_SUITE_P(Threads, SortedPairs, testing::Values(1, 3));

constexpr std::int32_t largest = std::numeric_limits<std::int32_t>::max();

TEST_P(SortedPairs, pairs_of_small_and_large_indices_are_sorted) {
    for (const bool low_memory : {false, true}) {
        for (const std::int32_t seconds : {40, 1000, 1 << 18, (1 << 22) - 1, 1 << 22, 1 << 23, largest})
            expect_sorted({5000, seconds, 0, 0, 5000}, 20'000, low_memory);          // keys of 32 or of 64 bits
        expect_sorted({3'000'000, 3'000'000, 0, 0, 3'000'000}, 20'000, low_memory);  // buckets of more first indices
    }
}
TEST_P(SortedPairs, pairs_in_few_buckets_are_sorted) {
    for (const bool low_memory : {false, true}) {
        expect_sorted({50'000, 1 << 18, 0, 1024, 1025}, 30'000, low_memory);
        expect_sorted({50'000, largest, 0, 49'000, 50'000}, 30'000, low_memory);
    }
}
TEST_P(SortedPairs, pairs_whose_second_indices_start_at_an_offset_are_sorted) {
    for (const std::int32_t seconds : {1 << 18, 1 << 30}) expect_sorted({3000, seconds, 3000, 0, 3000}, 10'000, false);
}
TEST_P(SortedPairs, lists_of_at_most_two_pairs_are_sorted) {
    for (const std::size_t count : {0U, 1U, 2U}) expect_sorted({3000, 3000, 0, 0, 3000}, count, false);
}

}  // namespace
}  // namespace crumple::cpu
