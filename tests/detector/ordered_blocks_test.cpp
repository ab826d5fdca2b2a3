// Tests of blocks of rows that several threads produce in units of work, each unit by one thread: no row is lost, all
// blocks but the last are full, rows have the order of the units, and no block is delivered after take() has thrown.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "results/ordered_blocks.h"

namespace crumple {
namespace {

using Numbers = std::vector<int>;

OrderedBlocks<Numbers>::Work work(std::function<void(Numbers&)> take) {
    return {[] { return std::make_unique<Numbers>(); }, [](const Numbers& block) { return block.size(); },
            [](Numbers& to, Numbers& piece, std::size_t begin, std::size_t end) {
                to.insert(to.end(), piece.begin() + static_cast<std::ptrdiff_t>(begin),
                          piece.begin() + static_cast<std::ptrdiff_t>(end));
            },
            std::move(take), [](Numbers& block) { block.clear(); }};
}

/// Fills units of `pieces` pieces of 20 numbers each, begun in ascending order by `threads` threads.
void fill(OrderedBlocks<Numbers>& blocks, int threads, int units, int pieces) {
    std::atomic<int> next{0};
    std::vector<std::thread> workers;
    for (int t = 0; t < threads; ++t)
        workers.emplace_back([&] {
            try {
                for (int unit; (unit = next++) < units;) {
                    for (int p = 0; p < pieces; ++p) {
                        auto piece = blocks.make();
                        for (int i = 0; i < 20; ++i) piece->push_back((unit * pieces + p) * 20 + i);
                        blocks.add(unit, std::move(piece));
                    }
                    blocks.finish(unit);
                }
            } catch (const std::runtime_error&) {
                blocks.fail();
            }
        });
    for (std::thread& worker : workers) worker.join();
}

TEST(OrderedBlocks, blocks_hold_all_rows_in_order) {
    for (const int threads : {1, 2, 8})
        for (const int most : {7, 100, 1'000'000}) {
            Numbers all;
            std::vector<std::size_t> sizes;
            Cancellation cancellation;
            cancellation.begin({});
            OrderedBlocks<Numbers> blocks(most, cancellation, work([&](Numbers& block) {
                                              all.insert(all.end(), block.begin(), block.end());
                                              sizes.push_back(block.size());
                                          }));
            constexpr int units = 200, pieces = 5, each = 20 * pieces;
            fill(blocks, threads, units, pieces);
            blocks.next_scene();
            fill(blocks, threads, units, pieces);
            blocks.finish();
            ASSERT_EQ(all.size(), std::size_t{2 * units * each});
            for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], static_cast<int>(i) % (units * each)) << i;
            for (std::size_t b = 0; b + 1 < sizes.size(); ++b) ASSERT_EQ(sizes[b], static_cast<std::size_t>(most));
        }
}

TEST(OrderedBlocks, no_block_is_delivered_after_the_consumer_has_thrown) {
    std::atomic<int> taken{0};
    Cancellation cancellation;
    cancellation.begin({});
    OrderedBlocks<Numbers> blocks(5, cancellation, work([&](Numbers&) {
                                      if (++taken == 3) throw std::runtime_error("full");
                                  }));
    fill(blocks, 4, 1000, 3);
    EXPECT_EQ(taken, 3);
}

TEST(OrderedBlocks, cancellation_ends_a_wait_for_an_earlier_unit) {
    std::stop_source stop;
    Cancellation cancellation;
    cancellation.begin(stop.get_token());
    OrderedBlocks<Numbers> blocks(10, cancellation, work([](Numbers&) {}));
    std::thread late([&] {
        auto piece = blocks.make();
        piece->assign(100, 1);
        EXPECT_THROW(blocks.add(1, std::move(piece)), Error) << "unit 0 never ends";
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until the other thread waits
    stop.request_stop();
    late.join();
}

}  // namespace
}  // namespace crumple
