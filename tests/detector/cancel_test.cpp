// Tests of cancellation: a call ends early on a stop request from another thread or if the caller's poll throws, and
// the detector stays usable.

#include <gtest/gtest.h>

#include <atomic>
#include <stop_token>
#include <thread>
#include <vector>

#include "crumple/error.h"
#include "detector/each_check_polls.h"
#include "rounds.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;

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
    options.memory_limit = Detector().find(mesh).statistics.peak_memory_bytes * 3 / 5;
    return options;
}

// Calls long enough to show that a stop request ends them early. Sanitizers slow everything down.
std::vector<Case> cases() {
    const int many = sanitized ? 40'000 : 60'000;
    const double size = 0.15;
    return {{"one thread", with_threads(1), many, size},
            {"two threads", with_threads(2), many, size},
            {"in chunks", with_limit(test::random_soup(many, size).view()), many, size},
            {"reference", reference(), 1500, 0.3}};
}

/// Makes the call, requests a stop once it has begun, and returns true if it threw Error (cancelled). On a busy machine
/// the thread that requests the stop may come too late, so there are up to five attempts.
template <class Call>
bool cancelled(Call call) {
    for (int attempt = 0; attempt < 5; ++attempt) {
        std::stop_source source;
        std::atomic<bool> begins{false};
        std::thread other([&] {
            while (!begins) std::this_thread::yield();
            source.request_stop();
        });
        bool threw = false;
        try {
            begins = true;
            call(source.get_token());
        } catch (const Error& error) {
            threw = error.code == ErrorCode::cancelled;
        }
        other.join();
        if (threw) return true;
    }
    return false;
}

TEST(Cancellation, stop_request_of_another_thread_cancels_find_and_detector_stays_usable) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto soup = test::random_soup(c.triangles, c.size);
        Detector detector(c.options);
        const auto expected = pairs_of(detector.find(soup.view()));
        EXPECT_TRUE(cancelled([&](std::stop_token stop) { detector.find(soup.view(), {}, stop); }));
        EXPECT_TRUE(detector.take_result<Intersections>().pairs.empty());
        if (c.options.memory_limit == 0) {  // the limit for one mesh is too small for all pairs between two
            EXPECT_TRUE(cancelled([&](std::stop_token stop) { detector.find({soup.view(), soup.view()}, {}, stop); }));
        }
        EXPECT_EQ(difference(expected, pairs_of(detector.find(soup.view()))), "");
    }
}

// The next call frees the cancelled call's memory first, so its peak equals that of a new detector.
TEST(Cancellation, peak_memory_after_a_cancelled_call_equals_that_of_a_new_detector) {
    struct Interrupt {};
    const test::EachCheckPolls each_check_polls;
    const auto large = test::random_soup(20'000, 0.1), small = test::random_soup(500, 0.2);
    int checks = 0, next = 0;
    {
        Detector detector({.threads = 1});
        detector.set_poll([&] { ++checks; });
        detector.find(large.view());
    }
    ASSERT_GT(checks, 3);
    const std::int64_t expected = Detector({.threads = 1}).find(small.view()).statistics.peak_memory_bytes;
    for (const int last : {1, checks / 2, checks}) {
        SCOPED_TRACE(last);
        Detector detector({.threads = 1});
        next = 0;
        detector.set_poll([&] {
            if (++next == last) throw Interrupt{};
        });
        EXPECT_THROW(detector.find(large.view()), Interrupt);
        EXPECT_TRUE(detector.take_result<Intersections>().pairs.empty());
        EXPECT_EQ(detector.find(small.view()).statistics.peak_memory_bytes, expected);
        EXPECT_EQ(detector.find(large.view()).pairs.size(), Detector({.threads = 1}).find(large.view()).pairs.size());
    }
}

TEST(Cancellation, stop_requested_before_a_call_cancels_it) {
    const auto soup = test::random_soup(500, 0.2);
    const MeshView mesh = soup.view();
    std::stop_source source;
    source.request_stop();
    const std::stop_token stop = source.get_token();
    for (const Backend backend : {Backend::cpu, Backend::reference}) {
        Detector detector({.backend = backend});
        const auto expected = pairs_of(detector.find(mesh));
        const Part part = detector.partition(mesh, {}, 3)[1], part_between = detector.partition({mesh, mesh}, {}, 3)[1];
        const auto ends = [&](const char* what, auto call) {
            try {
                call();
                ADD_FAILURE() << what;
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::cancelled) << what;
            }
        };
        ends("find_self", [&] { detector.find(mesh, {}, stop); });
        ends("find_self, a query", [&] { detector.find(mesh, {.weld = true}, stop); });
        ends("find, a part", [&] { detector.find(part, {}, stop); });
        ends("find_between", [&] { detector.find({mesh, mesh}, {}, stop); });
        ends("find, a part of two meshes", [&] { detector.find(part_between, {}, stop); });
        ends("has_collision", [&] { detector.any(mesh, {}, stop); });
        ends("has_collision, two", [&] { detector.any({mesh, mesh}, {}, stop); });
        const auto never = [](const Intersections&) { FAIL(); };
        ends("stream_self", [&] { detector.stream(mesh, {}, never, 100, stop); });
        ends("stream_between", [&] { detector.stream({mesh, mesh}, {}, never, 100, stop); });
        ends("partition", [&] { detector.partition(mesh, {}, 3, stop); });
        ends("partition, two", [&] { detector.partition({mesh, mesh}, {}, 3, stop); });
        ends("nothing to do", [&] { detector.find(MeshView(), {}, stop); });
        EXPECT_EQ(difference(expected, pairs_of(detector.find(mesh))), "") << "the next call has no token";
        EXPECT_EQ(difference(expected, pairs_of(detector.find(mesh, {}, std::stop_source().get_token()))), "");
    }
}

TEST(Cancellation, exception_of_poll_ends_the_call) {
    struct Interrupt {};
    const test::EachCheckPolls each_check_polls;
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto soup = test::random_soup(c.triangles, c.size);
        Detector detector(c.options);
        detector.set_poll([caller = std::this_thread::get_id()] {
            EXPECT_EQ(std::this_thread::get_id(), caller);
            throw Interrupt{};
        });
        EXPECT_THROW(detector.find(soup.view()), Interrupt);
        std::stop_source source;
        detector.set_poll([&] { source.request_stop(); });
        try {
            detector.find(soup.view(), {}, source.get_token());
            ADD_FAILURE() << "not cancelled";
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::cancelled);
        }
        detector.set_poll({});
        EXPECT_FALSE(detector.find(soup.view()).pairs.empty());
    }
}

}  // namespace
}  // namespace crumple
