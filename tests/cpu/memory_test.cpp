// Tests of the memory limit: a call that succeeds never exceeds it, and a call that fails names a lower bound of the
// limit that it needs.

#include <gtest/gtest.h>

#include "agreement/compare.h"
#include "error_of.h"
#include "memory_limit.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::error_of;
using test::pairs_of;

TEST(MemoryLimit, limited_call_gives_same_result_or_names_larger_limit) {
    const auto sheet = test::wavy_sheet(80);
    const auto soup = test::random_soup(1000, 0.15);
    for (const Backend backend : {Backend::cpu, Backend::reference}) {
        for (const bool contacts : {false, true}) {
            for (const MeshView& mesh : {sheet.view(), soup.view()}) {
                if (backend == Backend::reference && mesh.triangles.rows > 1000) continue;
                IntersectionQuery query;
                query.output = contacts ? Output::contacts : Output::pairs;
                Detector free({.backend = backend, .threads = 2});
                const Intersections expected = free.find(mesh, query);
                bool refused = false;
                for (std::int64_t limit = expected.statistics.peak_memory_bytes; limit > 10000; limit = limit * 3 / 5) {
                    const Options options{.backend = backend, .threads = 2, .memory_limit = limit};
                    Detector limited(options);
                    try {
                        const Intersections& found = limited.find(mesh, query);
                        EXPECT_TRUE(test::same_result(found, expected)) << limit << " bytes";
                        EXPECT_LE(found.statistics.peak_memory_bytes, limit);
                    } catch (const Error& error) {
                        ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
                        EXPECT_GT(error.bytes_needed, limit);
                        refused = true;
                        test::sufficient_limit(options, [&](Detector& enough) {
                            EXPECT_EQ(difference(pairs_of(expected), pairs_of(enough.find(mesh, query))), "");
                        });
                        // The detector that threw remains usable.
                        EXPECT_EQ(limited.find(MeshView()).pairs.size(), 0u);
                    }
                }
                EXPECT_TRUE(refused) << "no limit was too small";
            }
        }
    }
}

TEST(MemoryLimit, two_welded_meshes_give_the_same_pairs_under_a_limit) {
    auto a = test::wavy_sheet(50), b = test::wavy_sheet(60, 0.4);
    a.groups.assign(a.triangles.size(), 1);
    b.groups.assign(b.triangles.size(), 2);
    IntersectionQuery query;
    query.weld = true;
    query.filter.groups = PairScope::between;
    Detector free;
    const auto expected = pairs_of(free.find({a.view(), b.view()}, query));
    ASSERT_GT(expected.size(), 100u);
    const std::int64_t enough = test::sufficient_limit({}, [&](Detector& detector) {
        EXPECT_EQ(difference(expected, pairs_of(detector.find({a.view(), b.view()}, query))), "");
    });
    EXPECT_GT(enough, 1);
}

TEST(MemoryLimit, leftovers_of_earlier_calls_are_dropped_before_a_call_fails) {
    const auto a = test::wavy_sheet(50), b = test::wavy_sheet(60, 0.4), large = test::wavy_sheet(80);
    IntersectionQuery query;
    query.weld = true;
    const auto needed = [](auto call) { return test::sufficient_limit({}, call, 4); };
    const auto between = [&](Detector& detector) { detector.find({a.view(), b.view()}, query); };
    const auto within = [&](Detector& detector) { detector.find(large.view()); };
    Detector enough({.memory_limit = std::max(needed(between), needed(within))});
    for (int round = 0; round < 2; ++round) {
        EXPECT_NO_THROW(within(enough));
        EXPECT_NO_THROW(between(enough));
    }
}

/// Returns copies of one triangle, which either all use the same three vertices or have equal vertices of their own.
test::Soup<float> stack(std::int32_t count, bool by_index) {
    test::Soup<float> soup;
    for (std::int32_t i = 0; i < count; ++i) {
        const std::int32_t first = by_index ? 0 : 3 * i;
        if (i == 0 || !by_index) soup.vertices.insert(soup.vertices.end(), {{0, 0, 0}, {1, 0, 0.3f}, {0.2f, 1, 0}});
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

TEST(MemoryLimit, too_many_pairs_of_duplicated_faces_end_the_call_early) {
    constexpr std::int32_t n = 3000;
    constexpr std::int64_t limit = 5'000'000;
    for (const bool by_index : {true, false}) {
        const auto soup = stack(n, by_index), half = stack(n / 2, by_index);
        Detector detector({.threads = 2, .memory_limit = limit});
        for (int round = 0; round < 2; ++round) {
            const Error error = error_of([&] { detector.find(soup.view()); });
            EXPECT_EQ(error.code, ErrorCode::memory_limit);
            EXPECT_GT(error.bytes_needed, limit);
            EXPECT_LT(error.bytes_needed, std::int64_t{8} * n * (n - 1) / 2) << "it was counted on";
            EXPECT_NE(std::string(error.what()).find("at least " + std::to_string(error.bytes_needed) + " bytes"),
                      std::string::npos)
                << error.what();
        }
        EXPECT_GT(error_of([&] { detector.find({half.view(), half.view()}); }).bytes_needed, limit);
        EXPECT_TRUE(detector.any(soup.view()));
        const Part part = detector.partition(soup.view(), {}, 2)[0];
        EXPECT_GT(error_of([&] { detector.find(part); }).bytes_needed, limit);
    }
}

TEST(MemoryLimit, counting_ends_when_pairs_alone_exceed_the_limit) {
    const auto soup = test::random_soup(4000, 1);
    Detector free;
    const Intersections expected = free.find(soup.view());
    const auto pairs = static_cast<std::int64_t>(expected.pairs.size());
    ASSERT_GT(pairs, 200'000);
    const std::int64_t limit = pairs * 8 / 4;
    for (const int threads : {1, 2}) {
        Detector detector({.threads = threads, .memory_limit = limit});
        const Error error = error_of([&] { detector.find(soup.view()); });
        EXPECT_GT(error.bytes_needed, limit);
        EXPECT_LT(error.bytes_needed, 8 * pairs / 2) << "it was counted on";
    }
}

// If the limit does not suffice for storing pairs while they are found, the call searches in chunks (one cluster after
// another), once to count the pairs and once to store them.
TEST(MemoryLimit, pairs_are_found_under_a_limit_that_barely_suffices) {
    const auto soup = test::random_soup(3000, 0.7);
    Detector free;
    const auto expected = pairs_of(free.find(soup.view()));
    const std::int64_t limit = test::sufficient_limit(
        {}, [&](Detector& detector) { detector.find(soup.view()); }, 4);
    for (const int threads : {1, 2}) {
        Detector detector({.threads = threads, .memory_limit = limit});
        for (int round = 0; round < 2; ++round) {
            const Intersections& found = detector.find(soup.view());
            EXPECT_EQ(difference(expected, pairs_of(found)), "");
            EXPECT_LE(found.statistics.peak_memory_bytes, limit);
        }
    }
}

// Memory that the detector caches from earlier calls is not counted in the number of bytes that an error names.
TEST(MemoryLimit, needed_bytes_exclude_leftovers_of_earlier_calls) {
    const auto small = test::wavy_sheet(60), large = test::wavy_sheet(80);
    const auto soup = stack(60000, true);
    const auto least_of = [&](Detector& detector) {
        return error_of([&] { detector.find(soup.view()); }).bytes_needed;
    };
    Detector fresh({.memory_limit = 20'000'000}), used({.memory_limit = 20'000'000});
    for (const auto* mesh : {&large, &small}) used.find(mesh->view(), {.output = Output::contacts, .weld = true});
    const std::int64_t least = least_of(fresh);
    EXPECT_GT(least, 20'000'000);
    EXPECT_LT(least_of(used), least + 1'000'000) << "with what is kept it were several millions more";
}

}  // namespace
}  // namespace crumple
