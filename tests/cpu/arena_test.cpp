// Tests that callers of oneTBB can use detectors in tasks, in an arena of any size.

#ifndef CRUMPLE_STD_THREADS

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;

TEST(Arena, detectors_inside_callers_tasks_give_the_same_pairs) {
    const auto sheet = test::wavy_sheet(60);
    Detector plain;
    const auto expected = pairs_of(plain.find(sheet.view()));
    for (const int size : {1, 2, 7}) {
        tbb::task_arena arena(size);
        std::vector<std::string> results(12);
        arena.execute([&] {
            tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
                Detector detector({.threads = static_cast<int>(i % 4), .leaf_size = 200});
                results[i] = difference(expected, pairs_of(detector.find(sheet.view())));
            });
        });
        for (const std::string& result : results) EXPECT_EQ(result, "") << "arena of " << size;
    }
}

}  // namespace
}  // namespace crumple

#endif
