// A call ends early when another thread, or what the caller polls, says so; the detector stays usable.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "crumple/error.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;
using Clock = std::chrono::steady_clock;

struct Case {
    const char* name;
    Options options;
    int triangles;
    double size;
};

Options with_threads(int threads) {
    Options options;
    options.threads = threads;
    return options;
}

Options reference() {
    Options options;
    options.backend = Backend::reference;
    return options;
}

Options with_limit(const MeshView& mesh) {
    Options options;
    options.memory_limit = Detector().find_self(mesh).statistics.peak_memory_bytes * 3 / 5;
    return options;
}

// Long enough that a request which is only seen at the end would show; sanitizers make all things long.
std::vector<Case> cases() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    const int many = 20000;
#else
    const int many = 60000;
#endif
    const double size = 0.15;
    return {{"one thread", with_threads(1), many, size},
            {"two threads", with_threads(2), many, size},
            {"in chunks", with_limit(test::random_soup(many, size).view()), many, size},
            {"reference", reference(), 1500, 0.3}};
}

/// Cancels from the moment that the call is about to begin until it has ended; true if it threw.
template <class Call>
bool cancelled(Detector& detector, Call call) {
    std::atomic<bool> ended{false};
    std::thread other([&] {
        while (!ended) {
            detector.cancel();
            std::this_thread::yield();
        }
    });
    bool threw = false;
    try {
        call();
    } catch (const Error& error) {
        threw = error.code == ErrorCode::cancelled;
    }
    ended = true;
    other.join();
    return threw;
}

TEST(Cancel, ends_the_running_call_and_leaves_the_detector_usable) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto soup = test::random_soup(c.triangles, c.size);
        Detector detector(c.options);
        const auto begin = Clock::now();
        const auto expected = pairs_of(detector.find_self(soup.view()));
        const auto whole = Clock::now() - begin;
        const auto again = Clock::now();
        EXPECT_TRUE(cancelled(detector, [&] { detector.find_self(soup.view()); }));
        EXPECT_LT(Clock::now() - again, whole / 2);
        EXPECT_TRUE(detector.take_result().pairs.empty());
        EXPECT_TRUE(cancelled(detector, [&] { detector.find_between(soup.view(), soup.view()); }));
        EXPECT_EQ(difference(expected, pairs_of(detector.find_self(soup.view()))), "");
    }
}

TEST(Cancel, does_nothing_while_no_call_runs) {
    const auto soup = test::random_soup(500, 0.2);
    Detector detector;
    detector.cancel();
    const auto expected = pairs_of(detector.find_self(soup.view()));
    detector.cancel();
    EXPECT_EQ(difference(expected, pairs_of(detector.find_self(soup.view()))), "");
    EXPECT_TRUE(detector.has_collision(soup.view()));
}

TEST(Cancel, what_poll_throws_ends_the_call) {
    struct Interrupt {};
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto soup = test::random_soup(c.triangles, c.size);
        Detector detector(c.options);
        detector.set_poll([caller = std::this_thread::get_id()] {
            EXPECT_EQ(std::this_thread::get_id(), caller);
            throw Interrupt{};
        });
        EXPECT_THROW(detector.find_self(soup.view()), Interrupt);
        detector.set_poll([&] { detector.cancel(); });
        try {
            detector.find_self(soup.view());
            ADD_FAILURE() << "not cancelled";
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::cancelled);
        }
        detector.set_poll({});
        EXPECT_FALSE(detector.find_self(soup.view()).pairs.empty());
    }
}

}  // namespace
}  // namespace crumple
