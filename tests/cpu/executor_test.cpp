// Tests of executors, which run a detector's tasks on the application's threads: same results to the byte; errors and
// cancellation pass through.

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <random>
#include <stdexcept>
#include <stop_token>
#include <thread>

#include "cpu/executors.h"
#include "error_of.h"
#include "soups.h"

namespace crumple {
namespace {

using test::error_of;

template <class T>
void expect_same(const char* what, const Array<T>& a, const Array<T>& b) {
    EXPECT_TRUE(a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0))
        << what;
}

void expect_same(const Intersections& expected, const Intersections& found) {
    EXPECT_EQ(test::difference(test::pairs_of(expected), test::pairs_of(found)), "");
    expect_same("offsets", expected.offsets, found.offsets);
    expect_same("hit", expected.hit, found.hit);
    expect_same("hit_second", expected.hit_second, found.hit_second);
    expect_same("kinds", expected.contacts.kinds, found.contacts.kinds);
    expect_same("contact offsets", expected.contacts.offsets, found.contacts.offsets);
    expect_same("points", expected.contacts.points, found.contacts.points);
}

std::vector<std::shared_ptr<Executor>> executors() {
    return {std::make_shared<test::Serial>(), std::make_shared<test::Backwards>(), std::make_shared<test::Threads>(4),
            std::make_shared<test::Threads>(3, false)};
}

TEST(Executor, callers_executors_give_the_same_bytes_as_one_thread) {
    const auto sheet = test::wavy_sheet(60), other = test::wavy_sheet(50, 0.4);
    const IntersectionQuery query{.output = Output::contacts, .weld = true};
    Detector own({.backend = Backend::cpu, .threads = 1, .leaf_size = 300});
    const Intersections self = own.find(sheet.view(), query);
    const Intersections between = own.find({sheet.view(), other.view()});
    const std::vector<Part> parts = own.partition(sheet.view(), {}, 5);
    const Intersections of_part = own.find(parts[2]);
    ASSERT_GT(self.pairs.size(), 100u);
    for (const auto& executor : executors()) {
        const auto watched = std::make_shared<test::Watched>(executor);
        Detector detector({.backend = Backend::cpu, .leaf_size = 300, .executor = watched});
        for (int frame = 0; frame < 2; ++frame) {
            expect_same(self, detector.find(sheet.view(), query));
            expect_same(between, detector.find({sheet.view(), other.view()}));
        }
        EXPECT_EQ(detector.partition(sheet.view(), {}, 5)[2].mesh.ids, parts[2].mesh.ids);
        expect_same(of_part, detector.find(parts[2]));
        EXPECT_TRUE(detector.any(sheet.view()));
        EXPECT_EQ(detector.find(sheet.view()).statistics.threads, executor->concurrency());
        EXPECT_GT(watched->loops, 0) << "it was not asked";
        EXPECT_FALSE(watched->overlapped) << "a loop within a loop";
        EXPECT_FALSE(watched->threw);
    }
}

/// Needles along the sweep direction, few of which intersect: one leaf with so much work that its sweep is split into
/// tiles, which several threads can run.
test::Soup<float> needles() {
    test::Soup<float> soup;
    std::mt19937 engine(3);
    const auto number = [&] { return static_cast<float>(static_cast<double>(engine()) * 0x1p-32); };
    for (std::int32_t t = 0; t < 5000; ++t) {
        const float x = 20 * number(), y = number(), z = number();
        soup.vertices.push_back({x, y, z});
        soup.vertices.push_back({x + 12, y + 0.002f, z});
        soup.vertices.push_back({x + 12, y, z + 0.002f});
        soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return soup;
}

TEST(Executor, one_large_leaf_gives_the_same_bytes_without_nested_loops) {
    const auto soup = needles();
    Detector own({.backend = Backend::cpu, .threads = 1, .clusters = 1, .leaf_size = 100000});
    const Intersections expected = own.find(soup.view());
    ASSERT_GT(expected.statistics.interval_tests, 5'000'000) << "enough for tiles";
    // Executor that records the largest number of tasks of a loop.
    struct Counting : test::Threads {
        Counting() : Threads(3) {}
        void parallel_for(std::size_t n, test::Loop task) override {
            most = std::max(most, n);
            Threads::parallel_for(n, task);
        }
        std::size_t most = 0;
    };
    for (const bool alone : {true, false}) {
        const auto counting = std::make_shared<Counting>();
        const auto watched = std::make_shared<test::Watched>(counting);
        Detector detector({.backend = Backend::cpu,
                           .clusters = alone ? 1 : 2,
                           .leaf_size = alone ? 100000 : 1000,
                           .executor = watched});
        expect_same(expected, detector.find(soup.view()));
        EXPECT_FALSE(watched->overlapped);
        EXPECT_GE(counting->most, 4u);
    }
}

TEST(Executor, exception_of_poll_ends_the_call_and_bypasses_the_executor) {
    struct Interrupt {};
    struct Slow : test::Serial {
        void parallel_for(std::size_t n, test::Loop task) override {
            std::this_thread::sleep_for(std::chrono::milliseconds(30));  // longer than the interval between polls
            Serial::parallel_for(n, task);
        }
    };
    const auto sheet = test::wavy_sheet(60);
    const auto watched = std::make_shared<test::Watched>(std::make_shared<Slow>());
    Detector detector({.backend = Backend::cpu, .executor = watched});
    const auto expected = test::pairs_of(detector.find(sheet.view()));
    detector.set_poll([] { throw Interrupt{}; });
    EXPECT_THROW(detector.find(sheet.view()), Interrupt);
    EXPECT_FALSE(watched->threw);
    detector.set_poll({});
    EXPECT_EQ(test::difference(expected, test::pairs_of(detector.find(sheet.view()))), "");
}

TEST(Executor, stop_request_ends_the_call) {
    struct Stopping : test::Threads {
        Stopping() : Threads(3) {}
        void parallel_for(std::size_t n, test::Loop task) override {
            if (++loops == 3) source.request_stop();
            Threads::parallel_for(n, task);
        }
        std::stop_source source;
        int loops = 0;
    };
    const auto sheet = test::wavy_sheet(60);
    const auto stopping = std::make_shared<Stopping>();
    Detector detector({.backend = Backend::cpu, .leaf_size = 300, .executor = stopping});
    const Error error = error_of([&] { detector.find(sheet.view(), {}, stopping->source.get_token()); });
    EXPECT_EQ(error.code, ErrorCode::cancelled);
    EXPECT_EQ(stopping->loops, 3) << "it went on";
    EXPECT_FALSE(detector.find(sheet.view()).pairs.empty());
}

TEST(Executor, exception_of_the_executor_ends_the_call) {
    struct Failing : test::Serial {
        void parallel_for(std::size_t n, test::Loop task) override {
            if (fails) throw std::runtime_error("no thread is left");
            Serial::parallel_for(n, task);
        }
        bool fails = false;
    };
    const auto sheet = test::wavy_sheet(60);
    const auto failing = std::make_shared<Failing>();
    Detector detector({.backend = Backend::cpu, .executor = failing});
    const auto expected = test::pairs_of(detector.find(sheet.view()));
    failing->fails = true;
    EXPECT_THROW(detector.find(sheet.view()), std::runtime_error);
    failing->fails = false;
    EXPECT_EQ(test::difference(expected, test::pairs_of(detector.find(sheet.view()))), "");
}

TEST(Executor, invalid_concurrency_is_rejected) {
    for (const int count : {0, -1, 1025}) {
        const Error error = error_of([&] { Detector({.executor = std::make_shared<test::Threads>(count)}); });
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("executor"), std::string::npos) << error.what();
    }
}

TEST(Executor, executors_give_the_same_bytes_under_a_memory_limit) {
    const auto soup = test::random_soup(3000, 0.7);
    Detector own({.backend = Backend::cpu, .threads = 1});
    const Intersections expected = own.find(soup.view());
    for (const auto& executor : executors()) {
        const std::int64_t limit = expected.statistics.peak_memory_bytes * 3 / 5;
        Detector detector({.backend = Backend::cpu, .memory_limit = limit, .executor = executor});
        expect_same(expected, detector.find(soup.view()));
    }
}

}  // namespace
}  // namespace crumple
