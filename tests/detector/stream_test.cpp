// Tests of results in blocks: together the blocks have the rows of find(), for any block size, in another order.

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "error_of.h"
#include "memory_limit.h"
#include "rounds.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::error_of;
using test::pairs_of;
using test::Soup;

/// All blocks, concatenated.
struct Whole {
    std::vector<Pair> pairs;
    std::vector<ContactKind> kinds;
    std::vector<std::int64_t> counts;
    std::vector<std::array<double, 3>> points;
    std::int64_t blocks = 0, largest = 0;

    void add(const Intersections& block) {
        ++blocks;
        largest = std::max(largest, static_cast<std::int64_t>(block.pairs.size()));
        EXPECT_FALSE(block.pairs.empty());
        EXPECT_TRUE(block.offsets.empty());
        EXPECT_TRUE(block.hit.empty());
        append(block);
    }
    void append(const Intersections& block) {
        pairs.insert(pairs.end(), block.pairs.begin(), block.pairs.end());
        const Contacts& c = block.contacts;
        kinds.insert(kinds.end(), c.kinds.begin(), c.kinds.end());
        for (std::size_t i = 0; i < c.kinds.size(); ++i) counts.push_back(c.offsets[i + 1] - c.offsets[i]);
        points.insert(points.end(), c.points.begin(), c.points.end());
    }
    /// Sorts the rows by their pairs.
    void sort() {
        std::vector<std::size_t> order(pairs.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return pairs[i] < pairs[j]; });
        std::vector<std::int64_t> first(counts.size() + 1, 0);
        std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
        Whole sorted;
        for (const std::size_t i : order) {
            sorted.pairs.push_back(pairs[i]);
            if (kinds.empty()) continue;
            sorted.kinds.push_back(kinds[i]);
            sorted.counts.push_back(counts[i]);
            sorted.points.insert(sorted.points.end(), points.begin() + first[i], points.begin() + first[i + 1]);
        }
        sorted.blocks = blocks;
        sorted.largest = largest;
        *this = std::move(sorted);
    }
};

struct Meshes {
    MeshView a;
    const MeshView* b = nullptr;

    const Intersections& find(Detector& by, const IntersectionQuery& query) const {
        return b ? by.find({a, *b}, query) : by.find(a, query);
    }
    Statistics stream(Detector& by, FunctionRef<void(const Intersections&)> take, const IntersectionQuery& query,
                      std::int64_t rows) const {
        return b ? by.stream({a, *b}, query, take, rows) : by.stream(a, query, take, rows);
    }
};

void compare(const Meshes& meshes, const IntersectionQuery& query, const Options& options,
             std::initializer_list<int> sizes, std::int64_t least_pairs) {
    Detector plain;
    Whole expected;
    expected.append(meshes.find(plain, query));
    const auto count = static_cast<std::int64_t>(expected.pairs.size());
    ASSERT_GE(count, least_pairs);
    Detector detector(options);
    for (const int size : sizes) {
        SCOPED_TRACE(testing::Message() << "blocks of " << size);
        Whole found;
        const auto take = [&](const Intersections& block) { found.add(block); };
        const Statistics statistics = meshes.stream(detector, take, query, size);
        EXPECT_EQ(statistics.pairs, count);
        EXPECT_LE(found.largest, size);
        EXPECT_EQ(found.blocks, (count + size - 1) / size);
        found.sort();
        ASSERT_EQ(difference(expected.pairs, found.pairs), "");
        EXPECT_EQ(found.kinds, expected.kinds);
        EXPECT_EQ(found.counts, expected.counts);
        ASSERT_EQ(found.points.size(), expected.points.size());
        if (!found.points.empty()) {
            EXPECT_EQ(
                std::memcmp(found.points.data(), expected.points.data(), found.points.size() * sizeof found.points[0]),
                0);
        }
    }
}

/// Divisor of scene sizes, as sanitizers are slow.
constexpr int part = sanitized ? 2 : 1;

std::vector<Options> option_list() {
    std::vector<Options> result(4);
    result[0].threads = 1;
    result[1].threads = 3;
    result[1].clusters = 20;
    result[1].leaf_size = 50;
    result[2].threads = 2;
    result[2].memory_limit = 1 << 22;
    result[3].backend = Backend::reference;
    return result;
}

TEST(Stream, blocks_of_one_soup_hold_all_pairs) {
    const auto soup = test::random_soup(200 / part, 0.8);
    for (const Options& options : option_list())
        compare({soup.view()}, {.output = Output::contacts}, options, {1, 7, 300 / part, 1 << 18}, 500 / (part * part));
}

TEST(Stream, blocks_of_two_soups_hold_all_pairs) {
    const auto a = test::random_soup<float>(150 / part, 0.8);
    const auto b = test::random_soup<double>(120 / part, 0.9, 2);
    const MeshView second = b.view();
    for (const Options& options : option_list())
        compare({a.view(), &second}, {.output = Output::contacts}, options, {1, 50, 4000}, 400 / (part * part));
}

TEST(Stream, blocks_of_a_sheet_hold_all_pairs) {
    auto sheet = test::wavy_sheet(60);
    for (std::size_t t = 0; t < sheet.triangles.size(); ++t) sheet.groups.push_back(static_cast<std::int32_t>(t % 5));
    const std::vector<GroupPair> excluded{{0, 1}, {3, 3}};
    IntersectionQuery query;
    query.filter.excluded_groups = excluded;
    for (std::size_t i = 0; i < 3; ++i) {
        compare({sheet.view()}, {}, option_list()[i], {40, 1000, 100000}, 1000);
        compare({sheet.view()}, query, option_list()[i], {40, 1000}, 500);
    }
}

// One triangle has more pairs than a block holds.
TEST(Stream, pairs_of_one_triangle_may_span_blocks) {
    Soup<float> soup = test::random_soup(2000, 0.02);
    const auto n = static_cast<std::int32_t>(soup.vertices.size());
    for (std::size_t v = 0; v < soup.vertices.size(); ++v) soup.vertices[v][2] = static_cast<float>(v % 3) - 1.0f;
    soup.vertices.insert(soup.vertices.end(), {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}});
    soup.triangles.insert(soup.triangles.begin() + 5, {n, n + 1, n + 2});
    for (const Options& options : option_list()) {
        if (options.backend == Backend::reference) continue;
        compare({soup.view()}, {}, options, {100, 1500}, 2000);
    }
}

// Copies of degenerate triangles are searched once, and their pairs repeated.
TEST(Stream, copies_of_degenerate_triangles_each_have_their_pairs) {
    Soup<float> soup = test::random_soup(60, 0.8);
    for (const int where : {0, 20, 40}) {
        std::vector<std::array<std::int32_t, 3>> copies;
        for (std::int32_t i = 0; i < 40; ++i) copies.push_back({3 * (i % 4), 3 * (i % 4), 3 * (i % 4) + 61});
        soup.triangles.insert(soup.triangles.begin() + where, copies.begin(), copies.end());
    }
    const auto other = test::random_soup(40, 0.9, 7);
    const MeshView second = other.view();
    for (const Options& options : option_list()) {
        compare({soup.view()}, {.output = Output::contacts}, options, {1, 10, 500}, 350);
        compare({soup.view(), &second}, {}, options, {3, 200}, 100);
    }
}

TEST(Stream, order_does_not_depend_on_threads) {
    const auto soup = test::random_soup(3000, 0.3);
    const auto dense = test::random_soup(1500, 0.9);  // one large leaf, in tiles
    for (const MeshView& mesh : {soup.view(), dense.view()}) {
        std::vector<Pair> first;
        for (const int threads : {1, 2, 5}) {
            Detector detector({.backend = Backend::cpu, .threads = threads});
            std::vector<Pair> all;
            detector.stream(
                mesh, {},
                [&](const Intersections& block) { all.insert(all.end(), block.pairs.begin(), block.pairs.end()); },
                1000);
            if (threads == 1) first = all;
            ASSERT_EQ(all, first) << threads << " threads";
        }
        EXPECT_GT(first.size(), 3000u);
    }
}

TEST(Stream, empty_results_have_no_blocks) {
    Detector detector;
    const auto never = [](const Intersections&) { FAIL(); };
    EXPECT_EQ(detector.stream(MeshView(), {}, never).pairs, 0);
    const auto apart = test::random_soup(1, 0.1);
    EXPECT_EQ(detector.stream(apart.view(), {}, never).triangles, 1);
    EXPECT_EQ(detector.stream({apart.view(), MeshView()}, {}, never).pairs, 0);
}

TEST(Stream, exception_or_stop_request_ends_the_stream) {
    const auto soup = test::random_soup(2000, 0.5);
    Detector detector({.threads = 2});
    std::atomic<int> blocks{0};
    const auto refuse = [&](const Intersections&) {
        if (++blocks == 3) throw std::runtime_error("full");
    };
    EXPECT_THROW(detector.stream(soup.view(), {}, refuse, 50), std::runtime_error);
    EXPECT_EQ(blocks, 3);
    std::stop_source stop;
    blocks = 0;
    const auto request_stop = [&](const Intersections&) {
        ++blocks;
        stop.request_stop();
    };
    const Error error = error_of([&] { detector.stream(soup.view(), {}, request_stop, 50, stop.get_token()); });
    EXPECT_EQ(error.code, ErrorCode::cancelled);
    const std::vector<Pair> expected = pairs_of(Detector().find(soup.view()));
    EXPECT_LT(static_cast<std::size_t>(50 * blocks), expected.size() / 2) << "ends early";
    // The detector stays usable.
    Whole found;
    detector.stream(
        soup.view(), {}, [&](const Intersections& block) { found.add(block); }, 1000);
    found.sort();
    EXPECT_EQ(difference(expected, found.pairs), "");
}

TEST(Stream, stream_fits_a_limit_too_small_for_the_whole_result) {
    const auto soup = test::random_soup(4000, 0.9);
    const auto count = static_cast<std::int64_t>(Detector().find(soup.view()).pairs.size());
    constexpr std::int64_t limit = 2'500'000;
    ASSERT_GT(count * 8, limit);
    Detector detector({.memory_limit = limit});
    EXPECT_EQ(error_of([&] { detector.find(soup.view()); }).code, ErrorCode::memory_limit);
    std::int64_t pairs = 0;
    const auto take = [&](const Intersections& block) { pairs += static_cast<std::int64_t>(block.pairs.size()); };
    const Statistics statistics = detector.stream(soup.view(), {}, take, 20'000);
    EXPECT_EQ(pairs, count);
    EXPECT_LE(statistics.peak_memory_bytes, limit);

    pairs = 0;
    const Error error = error_of([&] { detector.stream(soup.view(), {}, take, 1'000'000); });
    EXPECT_EQ(error.code, ErrorCode::memory_limit);
    EXPECT_GT(error.bytes_needed, limit);
    test::sufficient_limit({.memory_limit = limit}, [&](Detector& enough) {
        pairs = 0;
        enough.stream(soup.view(), {}, take, 1'000'000);
        EXPECT_EQ(pairs, count);
    });
}

TEST(Stream, invalid_block_sizes_are_rejected) {
    const auto soup = test::random_soup(10, 0.2);
    for (const std::int64_t size : {std::int64_t{0}, std::int64_t{-5}, (std::int64_t{1} << 40) + 1}) {
        const Error error = error_of([&] {
            Detector().stream(
                soup.view(), {}, [](const Intersections&) {}, size);
        });
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_EQ(error.element, Element::option);
    }
}

}  // namespace
}  // namespace crumple
