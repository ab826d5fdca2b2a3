// Tests of overlaps in blocks: one after the other, the blocks are the same bytes as the result of find().

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <stop_token>

#include "error_of.h"
#include "memory_limit.h"
#include "overlaps/closed_bodies.h"
#include "overlaps/joined_rows.h"
#include "rounds.h"

namespace crumple {
namespace {

using test::closed_bodies;
using test::ClosedBodies;
using test::difference;
using test::error_of;
using test::JoinedRows;

/// Calls stream(), and checks each block and the statistics. Returns the blocks as one result.
Overlaps streamed(Detector& detector, const Scene& scene, const OverlapQuery& query, std::int64_t block_rows) {
    JoinedRows whole;
    bool last = false;
    const auto take = [&](const Overlaps& block) {
        EXPECT_FALSE(last);
        last = static_cast<std::int64_t>(block.bodies.size()) < block_rows;
        EXPECT_LE(static_cast<std::int64_t>(block.bodies.size()), block_rows);
        EXPECT_TRUE(block.world_hit.empty());
        whole.add(block);
        EXPECT_EQ(block.count, static_cast<std::int64_t>(whole.result.bodies.size()));
        whole.result.skipped = block.skipped;
        whole.result.body_volume = block.body_volume;
        whole.result.is_solid = block.is_solid;
    };
    const Statistics statistics = detector.stream(scene, query, take, block_rows);
    EXPECT_EQ(statistics.pairs, static_cast<std::int64_t>(whole.result.bodies.size()));
    return std::move(whole.result);
}

/// Returns a result as streamed() returns it.
Overlaps without_flags(Overlaps result) {
    result.world_hit.clear();
    return result;
}

class OverlapStream : public testing::TestWithParam<Options> {
   protected:
    Detector detector_{GetParam()};
    Detector plain_{Options{.backend = Backend::cpu, .threads = 1}};

    /// Compares blocks of several sizes with find(). Returns the number of rows.
    std::int64_t compare(const Scene& scene, const OverlapQuery& query) {
        const Overlaps expected = without_flags(plain_.find(scene, query));
        for (const int size : {1, 7, 100'000}) {
            SCOPED_TRACE(testing::Message() << "blocks of " << size);
            EXPECT_EQ(difference(streamed(detector_, scene, query, size), expected), "");
        }
        return expected.count;
    }
};

std::vector<Options> option_list() {
    return {{.backend = Backend::cpu, .threads = 1},
            {.backend = Backend::cpu, .threads = 3},
            {.backend = Backend::cpu, .threads = 1, .memory_limit = 1 << 26},
            {.backend = Backend::reference}};
}

constexpr std::array names{"One", "Three", "Limited", "Reference"};
INSTANTIATE_TEST_SUITE_P(, OverlapStream, testing::ValuesIn(option_list()),
                         [](const auto& option) { return names[option.index]; });

TEST_P(OverlapStream, blocks_are_the_bytes_of_the_whole_result) {
    const bool brute_force = GetParam().backend == Backend::reference;
    std::int64_t rows = 0, pairs = 0;
    for (unsigned seed = 0; seed < (thorough() ? 6u : 2u); ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, brute_force ? 5 : 12, seed % 2 == 0, seed % 2 == 1);
        rows += compare(bodies.view(), test::all_but_first_free);
        pairs += compare(bodies.view(), {.output = Output::body_pairs, .min_volume = 0.01});
        compare(bodies.view(), {.translation = true,
                                .solids = true,
                                .filter = {.groups = PairScope::between, .excluded_bodies = {{0, 1}, {3, 2}}}});
        compare(bodies.view(), {.self_overlaps = true, .filter = {.excluded_bodies = {{1, 1}, {0, 2}}}});
    }
    compare(closed_bodies(1, 5, false, true).view(), test::everything);
    EXPECT_GT(rows, brute_force ? 8 : 20);
    EXPECT_GT(pairs, brute_force ? 2 : 5);
}

TEST_P(OverlapStream, worlds_follow_each_other) {
    ClosedBodies bodies = closed_bodies(7, 12, true, false);
    for (std::size_t b = 0; b < 12; ++b) bodies.bodies[b].world = b >= 9 ? -1 : static_cast<std::int32_t>(b / 3 * 2);
    EXPECT_GT(compare(bodies.view(), test::all_but_first_free), 10);
}

TEST_P(OverlapStream, open_bodies_are_skipped_have_curves_or_are_an_error) {
    ClosedBodies bodies = closed_bodies(8, 6, true, false);
    for (const std::size_t b : {std::size_t{2}, std::size_t{5}}) {
        bodies.soups[b].triangles.pop_back();
        bodies.shapes[b] = Shape(bodies.soups[b].view());
    }
    OverlapQuery query = test::all_but_first_free;
    for (const OpenSurfaces open : {OpenSurfaces::skip, OpenSurfaces::curves}) {
        query.open = open;
        EXPECT_GT(compare(bodies.view(), query), 3);
    }
    query.open = OpenSurfaces::error;
    const auto never = [](const Overlaps&) { ADD_FAILURE(); };
    const Error error = error_of([&] { detector_.stream(bodies.view(), query, never); });
    EXPECT_STREQ(error.what(), error_of([&] { plain_.find(bodies.view(), query); }).what());
}

TEST_P(OverlapStream, meshes_are_bodies) {
    const ClosedBodies bodies = closed_bodies(9, 2, true, false);
    const MeshView a = bodies.soups[0].view(), b = bodies.soups[1].view();
    compare({a, b}, {.curves = true, .regions = true});
    compare(a, {.gradient = true, .windings = true});
}

TEST_P(OverlapStream, result_without_rows_has_one_block_if_it_has_lists_by_body) {
    const ClosedBodies bodies = closed_bodies(10, 1, true, false);
    for (const bool self : {false, true}) {
        std::int64_t blocks = 0, volumes = 0;
        const OverlapQuery query{.min_volume = 1e9, .self_overlaps = self};
        detector_.stream(bodies.view(), query, [&](const Overlaps& block) {
            ++blocks;
            volumes += static_cast<std::int64_t>(block.body_volume.size());
            EXPECT_TRUE(block.bodies.empty());
        });
        EXPECT_EQ(blocks, self ? 1 : 0);
        EXPECT_EQ(volumes, self ? 1 : 0);
    }
}

TEST_P(OverlapStream, stop_or_exception_ends_the_call_and_the_next_one_works) {
    const ClosedBodies bodies = closed_bodies(11, 8, true, false);
    std::stop_source source;
    int taken = 0;
    const auto stopping = [&](const Overlaps&) { ++taken, source.request_stop(); };
    EXPECT_EQ(error_of([&] { detector_.stream(bodies.view(), OverlapQuery(), stopping, 1, source.get_token()); }).code,
              ErrorCode::cancelled);
    EXPECT_EQ(taken, 1);
    const auto failing = [](const Overlaps&) { throw std::runtime_error("enough"); };
    EXPECT_THROW(detector_.stream(bodies.view(), OverlapQuery(), failing, 1), std::runtime_error);
    EXPECT_GT(compare(bodies.view(), {.curves = true}), 3);
}

TEST_P(OverlapStream, options_that_blocks_do_not_support_are_errors) {
    const ClosedBodies bodies = closed_bodies(12, 3, true, false);
    const auto never = [](const Overlaps&) { ADD_FAILURE(); };
    for (const Output output : {Output::any, Output::any_by_world})
        EXPECT_STREQ(error_of([&] { detector_.stream(bodies.view(), OverlapQuery{.output = output}, never); }).what(),
                     "output must be body_pairs or pairs: blocks list them");
    for (const std::int64_t rows : {std::int64_t{0}, (std::int64_t{1} << 40) + 1})
        EXPECT_STREQ(error_of([&] { detector_.stream(bodies.view(), OverlapQuery(), never, rows); }).what(),
                     "block_rows must be 1 to 2^40");
}

// In a pile of bodies, each of which meets many others, the rows and the pairs of triangles take most of the memory.
TEST(OverlapStreamMemory, blocks_of_a_pile_need_a_fraction_of_the_memory_of_the_whole_result) {
    const ClosedBodies bodies = closed_bodies(13, 50, false, false);
    Options options{.backend = Backend::cpu, .threads = 1};
    Detector whole(options), in_blocks(options);
    const OverlapQuery query{.curves = true, .regions = true};
    const Overlaps expected = whole.find(bodies.view(), query);
    std::int64_t rows = 0;
    const auto count = [&](const Overlaps& block) { rows += static_cast<std::int64_t>(block.bodies.size()); };
    const Statistics statistics = in_blocks.stream(bodies.view(), query, count, 16);
    EXPECT_EQ(rows, expected.count);
    EXPECT_LT(3 * statistics.peak_memory_bytes, expected.statistics.peak_memory_bytes);
    options.memory_limit = statistics.peak_memory_bytes + statistics.peak_memory_bytes / 4;
    Detector limited(options);
    EXPECT_EQ(difference(streamed(limited, bodies.view(), query, 16), without_flags(expected)), "");
    EXPECT_EQ(error_of([&] { limited.find(bodies.view(), query); }).code, ErrorCode::memory_limit);
}

}  // namespace
}  // namespace crumple
