// Tests of metered arrays and of swapping them.

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "crumple/array.h"

namespace crumple {
namespace {

using Ints = Array<int>;

TEST(Array, memory_meter_counts_storage_that_is_swapped_in) {
    MemoryMeter meter;
    Ints mine(&meter), others;
    mine.assign(100, 7);
    others.assign(1000, 8);
    const int* const storage = others.data();
    const std::size_t before = mine.capacity();
    mine.swap_elements(others);
    EXPECT_EQ(mine.data(), storage);
    EXPECT_EQ(mine.size(), 1000U);
    EXPECT_EQ(others[99], 7);
    EXPECT_EQ(meter.used, static_cast<std::int64_t>(mine.capacity() * sizeof(int)));
    mine.swap_elements(others);
    EXPECT_EQ(meter.used, static_cast<std::int64_t>(before * sizeof(int)));
    mine.release();
    others.release();
    EXPECT_EQ(meter.used, 0);
}

TEST(Array, swap_between_two_meters_updates_the_counts_of_both) {
    MemoryMeter first, second;
    Ints a(&first), b(&second);
    a.assign(100, 7);
    b.assign(1000, 8);
    a.swap_elements(b);
    EXPECT_EQ(first.used, static_cast<std::int64_t>(a.capacity() * sizeof(int)));
    EXPECT_EQ(second.used, static_cast<std::int64_t>(b.capacity() * sizeof(int)));
}

TEST(Array, swap_beyond_a_memory_limit_throws_and_changes_neither_array) {
    for (const bool limited_is_first : {true, false}) {
        MemoryMeter meter, unlimited;
        meter.limit = 1000;
        Ints small(&meter), large(&unlimited);
        small.assign(100, 7);
        large.assign(1000, 8);
        const std::int64_t used = meter.used, others = unlimited.used;
        const int *const of_small = small.data(), *const of_large = large.data();
        EXPECT_THROW(limited_is_first ? small.swap_elements(large) : large.swap_elements(small), MemoryMeter::Exceeded);
        EXPECT_EQ(small.size(), 100U);
        EXPECT_EQ(large.size(), 1000U);
        EXPECT_EQ(small.data(), of_small);
        EXPECT_EQ(large.data(), of_large);
        EXPECT_EQ(small[99], 7);
        EXPECT_EQ(large[999], 8);
        EXPECT_EQ(meter.used, used);
        EXPECT_EQ(unlimited.used, others);
    }
}

// Blocks of 32 MiB grow without a copy, smaller ones are copied; after each growth, the meter counts exactly the
// current block.
TEST(Array, growth_keeps_elements_and_meter_counts_each_block) {
    for (const std::size_t first : {std::size_t{1000}, std::size_t{8} << 20}) {
        MemoryMeter meter;
        Ints grown(&meter);
        for (std::size_t i = 0; i < first; ++i) grown.push_back(static_cast<int>(i));
        for (int growth = 0; growth < 3; ++growth) {
            grown.reserve(2 * grown.capacity());
            ASSERT_EQ(meter.used, static_cast<std::int64_t>(grown.capacity() * sizeof(int)));
            ASSERT_EQ(reinterpret_cast<std::uintptr_t>(grown.data()) % 64, 0U);
            for (std::size_t i = 0; i < first; ++i) ASSERT_EQ(grown[i], static_cast<int>(i));
            grown.data()[grown.capacity() - 1] = 1;
        }
        grown.release();
        EXPECT_EQ(meter.used, 0);
    }
}

TEST(Array, rejected_growth_changes_nothing) {
    for (const std::size_t first : {std::size_t{1000}, std::size_t{8} << 20}) {
        MemoryMeter meter;
        meter.limit = static_cast<std::int64_t>(2 * first * sizeof(int));
        Ints limited(&meter);
        limited.assign(first, 7);
        const std::int64_t used = meter.used;
        EXPECT_THROW(limited.reserve(2 * first + 1), MemoryMeter::Exceeded);
        EXPECT_EQ(meter.used, used);
        EXPECT_EQ(limited.size(), first);
        EXPECT_EQ(limited[first - 1], 7);
    }
}

TEST(MemoryMeter, rejected_allocation_does_not_raise_the_peak) {
    MemoryMeter meter;
    meter.limit = 1000;
    std::atomic<bool> done{false};
    std::thread greedy([&] {
        while (!done) EXPECT_THROW(meter.add(10'000), MemoryMeter::Exceeded);
    });
    for (int i = 0; i < 200'000; ++i) {
        meter.add(500);
        meter.add(-500);
    }
    done = true;
    greedy.join();
    EXPECT_EQ(meter.used, 0);
    EXPECT_EQ(meter.peak, 500);
}

TEST(Array, repeated_push_back_rarely_moves_elements) {
    for (const std::int64_t limit : {std::int64_t{0}, std::int64_t{1} << 30}) {
        MemoryMeter meter;
        meter.limit = limit;
        Ints list(&meter);
        int moves = 0;
        for (int i = 0; i < 100'000; ++i) {
            const int* const before = list.data();
            list.push_back(i);
            moves += list.data() != before;
        }
        EXPECT_LT(moves, 120) << limit;
        EXPECT_LE(list.capacity(), list.size() * 3 / 2);
        for (int i = 0; i < 100'000; ++i) ASSERT_EQ(list[i], i);
    }
}

}  // namespace
}  // namespace crumple
