// Blocks that several threads fill: nothing is lost, all but the last are full, and what take() throws is the last.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "results/filling_block.h"

namespace crumple {
namespace {

using Numbers = std::vector<int>;

FillingBlock<Numbers>::Work work(std::function<void(Numbers&)> take) {
    return {[] { return std::make_unique<Numbers>(); }, {}, std::move(take), [](Numbers& block) { block.clear(); }};
}

void add(FillingBlock<Numbers>& filling, int first, int count) {
    FillingBlock<Numbers>::Writer(filling).add(static_cast<std::size_t>(count),
                                               [&](Numbers& block, std::size_t begin, std::size_t end) {
                                                   for (std::size_t i = begin; i < end; ++i)
                                                       block.push_back(first + static_cast<int>(i));
                                               });
}

template <class Work>
void on_threads(int count, Work work) {
    std::vector<std::thread> threads;
    for (int t = 0; t < count; ++t) threads.emplace_back([=] { work(t); });
    for (std::thread& thread : threads) thread.join();
}

TEST(FillingBlock, has_all_that_threads_add) {
    constexpr int threads = 4, each = 5000, most = 7;
    Numbers all;
    std::vector<std::size_t> sizes;
    FillingBlock<Numbers> filling(most, work([&](Numbers& block) {
                                      all.insert(all.end(), block.begin(), block.end());
                                      sizes.push_back(block.size());
                                  }));
    on_threads(threads, [&](int t) {
        for (int done = 0; done < each; done += 20) add(filling, t * each + done, 20);
    });
    filling.finish();
    std::sort(all.begin(), all.end());
    ASSERT_EQ(all.size(), std::size_t{threads * each});
    for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], static_cast<int>(i));
    EXPECT_EQ(sizes.size(), std::size_t{(threads * each + most - 1) / most});
    EXPECT_EQ(std::count(sizes.begin(), sizes.end(), std::size_t{most}), threads * each / most);
}

TEST(FillingBlock, of_one_thread_is_in_order) {
    Numbers all;
    FillingBlock<Numbers> filling(3, work([&](Numbers& block) { all.insert(all.end(), block.begin(), block.end()); }));
    for (int i = 0; i < 100; i += 10) add(filling, i, 10);
    filling.finish();
    filling.finish();
    ASSERT_EQ(all.size(), 100u);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
}

TEST(FillingBlock, hands_nothing_over_once_take_has_thrown) {
    std::atomic<int> blocks{0}, thrown{0};
    FillingBlock<Numbers> filling(5, work([&](Numbers&) {
                                      if (++blocks == 3) throw std::runtime_error("full");
                                  }));
    on_threads(4, [&](int) {
        try {
            for (int i = 0; i < 1000; ++i) add(filling, i, 3);
        } catch (const std::runtime_error&) {
            ++thrown;
        }
    });
    EXPECT_EQ(blocks, 3);
    EXPECT_EQ(thrown, 1);
}

}  // namespace
}  // namespace crumple
