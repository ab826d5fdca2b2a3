// The memory limit: never exceeded by a call that succeeds, and a call that fails names a limit that suffices.

#include <gtest/gtest.h>

#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;

TEST(MemoryLimit, a_smaller_limit_gives_the_same_answer_or_says_what_suffices) {
    const auto sheet = test::wavy_sheet(80);
    const auto soup = test::random_soup(1000, 0.15);
    for (const Backend backend : {Backend::cpu, Backend::reference}) {
        for (const bool contacts : {false, true}) {
            for (const MeshView& mesh : {sheet.view(), soup.view()}) {
                if (backend == Backend::reference && mesh.triangles.rows > 1000) continue;
                Query query;
                query.contacts = contacts;
                Detector free({.backend = backend, .threads = 2});
                const Collisions expected = free.find_self(mesh, query);
                std::int64_t needed = 0;
                for (std::int64_t limit = expected.statistics.peak_memory_bytes; limit > 10000; limit = limit * 3 / 5) {
                    Detector limited({.backend = backend, .threads = 2, .memory_limit = limit});
                    try {
                        const Collisions& found = limited.find_self(mesh, query);
                        EXPECT_EQ(difference(pairs_of(expected), pairs_of(found)), "") << limit << " bytes";
                        EXPECT_LE(found.statistics.peak_memory_bytes, limit);
                        EXPECT_EQ(found.contacts.points.size(), expected.contacts.points.size());
                    } catch (const Error& error) {
                        ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
                        EXPECT_GT(error.bytes_needed, limit);
                        needed = error.bytes_needed;
                        Detector enough({.backend = backend, .threads = 2, .memory_limit = needed});
                        EXPECT_EQ(difference(pairs_of(expected), pairs_of(enough.find_self(mesh, query))), "")
                            << "the limit that the error named, " << needed;
                        // The one that threw is usable still.
                        EXPECT_EQ(limited.find_self(MeshView()).pairs.size(), 0u);
                    }
                }
                EXPECT_GT(needed, 0) << "no limit was too small";
            }
        }
    }
}

TEST(MemoryLimit, holds_between_two_meshes_with_welding_and_groups) {
    auto a = test::wavy_sheet(50), b = test::wavy_sheet(60, 0.4);
    a.groups.assign(a.triangles.size(), 1);
    b.groups.assign(b.triangles.size(), 2);
    Query query;
    query.weld = true;
    query.wanted = Wanted::between;
    Detector free;
    const auto expected = pairs_of(free.find_between(a.view(), b.view(), query));
    ASSERT_GT(expected.size(), 100u);
    Detector tiny({.memory_limit = 1});
    try {
        tiny.find_between(a.view(), b.view(), query);
        FAIL() << "one byte sufficed";
    } catch (const Error& error) {
        ASSERT_EQ(error.code, ErrorCode::memory_limit);
        Detector enough({.memory_limit = error.bytes_needed});
        EXPECT_EQ(difference(expected, pairs_of(enough.find_between(a.view(), b.view(), query))), "");
    }
}

TEST(MemoryLimit, what_earlier_calls_have_left_is_dropped_before_a_call_fails) {
    const auto a = test::wavy_sheet(50), b = test::wavy_sheet(60, 0.4), large = test::wavy_sheet(80);
    Query query;
    query.weld = true;
    const auto needed = [](auto call) {
        Detector tiny({.memory_limit = 1});
        try {
            call(tiny);
        } catch (const Error& error) {
            return error.bytes_needed;
        }
        return std::int64_t{0};
    };
    const auto between = [&](Detector& detector) { detector.find_between(a.view(), b.view(), query); };
    const auto within = [&](Detector& detector) { detector.find_self(large.view()); };
    Detector enough({.memory_limit = std::max(needed(between), needed(within))});
    for (int round = 0; round < 2; ++round) {
        EXPECT_NO_THROW(within(enough));
        EXPECT_NO_THROW(between(enough));
    }
}

}  // namespace
}  // namespace crumple
