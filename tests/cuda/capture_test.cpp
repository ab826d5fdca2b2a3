// Launches in a caller's capture: each replay of the caller's graph is a query. Plain CUDA: the CPU plays the device,
// or a device is there.

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "agreement/hard_soups.h"
#include "crumple/error.h"
#include "cuda/cloth.h"
#include "cuda/device_mesh.h"
#include "cuda/recorder.h"
#include "cuda/shows.h"
#include "error_of.h"
#include "halves.h"
#include "soups.h"

namespace crumple::test {
namespace {

void warm_up(Detector& cuda, const MeshView& mesh, const IntersectionQuery& query = {}) {
    for (int call = 0; call < 2; ++call) cuda.launch(mesh, query).wait();
}

/// Replays until the answer is complete: centres may move on, and triangles at one place change sides together, so that
/// even a scene at rest can take a second replay.
const DeviceIntersections& answer_of(const Recorder& recorder, const LaunchTicket<IntersectionQuery>& launched) {
    for (int replay = 0;; ++replay) {
        recorder.replay();
        const DeviceIntersections& found = launched.wait();
        if (found.complete || replay == 4) return found;
    }
}

std::string message_of(auto call) { return error_of(call).what(); }

TEST(CudaCapture, answers_each_replay) {
    for (const int leaf_size : {3000, 60}) {
        for (const bool contacts : {false, true}) {
            SCOPED_TRACE(testing::Message() << "leaves of " << leaf_size << ", contacts " << contacts);
            const IntersectionQuery query{.output = contacts ? Output::contacts : Output::pairs};
            Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda, .leaf_size = leaf_size});
            DeviceMesh device(cloth(600, 70).view());
            Recorder recorder;
            const MeshView view = recorder.on(device.view());
            warm_up(cuda, view, query);
            recorder.begin();
            const auto launched = cuda.launch(view, query);
            recorder.end();
            int complete = 0;
            for (int frame = 70; frame < 94; frame += 3) {
                const io::TriangleMesh mesh = cloth(600, frame);
                device.set_vertices(mesh.view());
                recorder.replay();
                const DeviceIntersections& found = launched.wait();
                if (!found.complete) continue;
                ++complete;
                const Intersections& expected = cpu.find(mesh.view(), query);
                EXPECT_TRUE(shows(found, view, nullptr, expected)) << "frame " << frame;
                EXPECT_EQ(found.pairs_needed, found.count);
                EXPECT_TRUE(same_answer(launched.download(), expected)) << "frame " << frame;
            }
            EXPECT_GE(complete, 4) << "of 8 frames that look like the ones before";
        }
    }
}

TEST(CudaCapture, tells_of_the_last_of_many_replays) {
    const io::TriangleMesh mesh = cloth(600, 93);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const DeviceMesh device(mesh.view());
    Recorder recorder;
    const MeshView view = recorder.on(device.view());
    for (int call = 0; call < 2; ++call) cuda.find(device.view());  // any call that lists pairs warms up
    recorder.begin();
    const auto launched = cuda.launch(view);
    recorder.end();
    for (int replay = 0; replay < 3; ++replay) recorder.replay();
    EXPECT_TRUE(shows(launched.wait(), view, nullptr, cpu.find(mesh.view())));
}

// What expansions cannot hold, and contacts in one plane, are the host's, in wait().
TEST(CudaCapture, has_the_host_decide_what_only_it_can) {
    const IntersectionQuery query{.output = Output::contacts};
    std::int64_t rational = 0, beyond = 0;
    for (const NamedMesh& scene : hard_soups()) {
        SCOPED_TRACE(scene.name);
        const DeviceMesh device(scene.mesh.view());
        Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
        const Intersections& expected = cpu.find(scene.mesh.view(), query);
        Recorder recorder;
        const MeshView view = recorder.on(device.view());
        warm_up(cuda, view, query);
        recorder.begin();
        const auto launched = cuda.launch(view, query);
        recorder.end();
        for (int replay = 0; replay < 2; ++replay) {
            const DeviceIntersections& found = answer_of(recorder, launched);
            EXPECT_TRUE(shows(found, view, nullptr, expected));
            rational += found.statistics.rational_contacts;
            beyond += found.statistics.rational_tests;
        }
    }
    EXPECT_GT(rational, 0);
    EXPECT_GT(beyond, 0);
}

TEST(CudaCapture, answers_between_two_meshes_whose_streams_it_joins) {
    const io::TriangleMesh mesh = cloth(700);
    const Halves half(mesh.view());
    const DeviceMesh a(half.a), b(half.b);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder, other;
    const MeshView first = recorder.on(a.view()), second = other.on(b.view());
    cudaEvent_t fork;
    check(cudaEventCreateWithFlags(&fork, cudaEventDisableTiming));
    for (int call = 0; call < 2; ++call) {
        cuda.launch({first, second}).wait();
    }
    recorder.begin();
    EXPECT_EQ(message_of([&] {
                  cuda.launch({first, second});
              }),
              "the streams of two meshes take part in one capture, or in none");
    check(cudaEventRecord(fork, recorder.stream()));
    check(cudaStreamWaitEvent(other.stream(), fork, 0));
    const auto launched = cuda.launch({first, second});
    recorder.end();
    EXPECT_TRUE(shows(answer_of(recorder, launched), half.a, &half.b, cpu.find({half.a, half.b})));
    check(cudaEventDestroy(fork));
}

// The legacy stream cannot be used while a blocking stream captures. The call is refused before it tries, so that the
// capture goes on.
TEST(CudaCapture, refuses_the_legacy_stream_beside_a_captured_one) {
    const io::TriangleMesh mesh = cloth(300);
    const Halves half(mesh.view());
    const DeviceMesh device(half.a), other(half.b);
    Detector cuda({.backend = Backend::cuda});
    cudaStream_t stream;
    check(cudaStreamCreate(&stream));
    MeshView a = device.view(), b = other.view();
    a.stream = stream;
    for (const cudaStream_t legacy : {cudaStream_t{}, cudaStreamLegacy}) {
        b.stream = legacy;
        check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
        const std::string refused = "the streams of two meshes take part in one capture, or in none";
        EXPECT_EQ(message_of([&] { cuda.launch({a, b}); }), refused);
        EXPECT_EQ(message_of([&] { cuda.launch({b, a}); }), refused);
        cudaGraph_t graph = nullptr;
        EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
        if (graph) check(cudaGraphDestroy(graph));
    }
    check(cudaStreamDestroy(stream));
}

TEST(CudaCapture, goes_on_when_a_detector_ends) {
    const DeviceMesh device(cloth(300, 93).view());
    const DeviceBytes bytes(std::vector<std::byte>(1));
    std::optional<Detector> cuda(std::in_place, Options{.backend = Backend::cuda});
    for (int call = 0; call < 3; ++call) cuda->launch(device.view()).wait();
    cuda->launch(device.view());  // the detector's end waits for it
    Recorder recorder;
    recorder.begin();
    check(cudaMemsetAsync(bytes.data(), 7, 1, recorder.stream()));
    cuda.reset();
    recorder.end();
    recorder.replay();
    EXPECT_EQ(to_host(static_cast<const unsigned char*>(bytes.data()), 1), std::vector<unsigned char>{7});
}

// A scene that jumps needs other lists. A call outside of the capture makes them.
TEST(CudaCapture, says_what_a_replay_lacks) {
    constexpr int n = 1500;
    const Soup<float> sparse = random_soup(n, 1e-3), dense = random_soup(n, 0.6, 2);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    const std::int64_t pairs = static_cast<std::int64_t>(cpu.find(dense.view()).pairs.size());
    ASSERT_GT(pairs, 3 * n);
    DeviceMesh device(sparse.view());
    Recorder recorder;
    const MeshView view = recorder.on(device.view());
    warm_up(cuda, view);
    recorder.begin();
    const auto launched = cuda.launch(view);
    recorder.end();
    device.set_vertices(dense.view());
    for (int replay = 0; replay < 2; ++replay) {
        recorder.replay();
        const DeviceIntersections found = launched.wait();
        EXPECT_FALSE(found.complete);
        EXPECT_GT(found.pairs_needed, 0);
        EXPECT_LE(found.pairs_needed, pairs);
        EXPECT_EQ(found.count, 0);
        EXPECT_EQ(found.pairs, nullptr);
        EXPECT_EQ(message_of([&] { launched.download(); }), "download() needs an answer that is complete");
    }
    // The graph still answers what fits: a jump spoils one replay, and what it has left guides the next ones.
    device.set_vertices(sparse.view());
    EXPECT_TRUE(shows(answer_of(recorder, launched), view, nullptr, cpu.find(sparse.view())));
    device.set_vertices(dense.view());
    warm_up(cuda, view);
    EXPECT_EQ(message_of([&] { launched.wait(); }),
              "there is nothing to wait for: another call has come after this launch");
    warm_up(cuda, view);
    recorder.begin();
    const auto again = cuda.launch(view);
    recorder.end();
    EXPECT_TRUE(shows(answer_of(recorder, again), view, nullptr, cpu.find(dense.view())));
}

TEST(CudaCapture, reports_bad_input_and_goes_on) {
    const Soup<float> good = random_soup(200, 0.2);
    Soup<float> bad = good;
    bad.vertices[17][1] = std::numeric_limits<float>::infinity();
    DeviceMesh device(good.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = recorder.on(device.view());
    warm_up(cuda, view);
    recorder.begin();
    const auto launched = cuda.launch(view);
    recorder.end();
    for (int turn = 0; turn < 3; ++turn) {
        device.set_vertices(bad.view());
        recorder.replay();
        EXPECT_EQ(message_of([&] { launched.wait(); }), "vertex 17 is not finite");
        device.set_vertices(good.view());
        ASSERT_TRUE(answer_of(recorder, launched).complete);
        EXPECT_TRUE(same_answer(launched.download(), cpu.find(good.view())));
    }
}

// Nothing that a refused launch does spoils the capture or what the detector keeps.
TEST(CudaCapture, refuses_what_has_no_lists_and_spoils_nothing) {
    io::TriangleMesh mesh = cloth(300, 93);
    mesh.groups.clear();
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) mesh.groups.push_back(t % 3);
    const DeviceMesh device(mesh.view()), other(cloth(500, 93).view());
    const DeviceBytes bytes(std::vector<std::byte>(4));
    const std::vector<GroupPair> some{{0, 1}};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = recorder.on(device.view());
    const auto expect_refused = [&](const MeshView& what, const IntersectionQuery& query) {
        recorder.begin();
        check(cudaMemsetAsync(bytes.data(), 7, 4, recorder.stream()));
        EXPECT_EQ(message_of([&] { cuda.launch(what, query); }).substr(0, 48),
                  "a launch in a capture needs two calls before it,");
        check(cudaMemsetAsync(bytes.data(), 9, 1, recorder.stream()));
        recorder.end();
        recorder.replay();
        EXPECT_EQ(to_host(static_cast<const unsigned char*>(bytes.data()), 2), (std::vector<unsigned char>{9, 7}));
    };
    expect_refused(view, {});
    cuda.launch(view).wait();
    expect_refused(view, {});
    warm_up(cuda, view);
    expect_refused(view, {.weld = true});
    warm_up(cuda, view);
    expect_refused(view, {.filter = {.excluded_groups = some}});
    warm_up(cuda, view);
    expect_refused(recorder.on(other.view()), {});
    warm_up(cuda, view);
    recorder.begin();
    const auto launched = cuda.launch(view);
    recorder.end();
    recorder.replay();
    EXPECT_TRUE(shows(launched.wait(), view, nullptr, cpu.find(mesh.view())));
}

TEST(CudaCapture, tells_when_it_is_asked_out_of_turn) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = recorder.on(device.view());
    const Intersections expected = cpu.find(mesh.view());
    warm_up(cuda, view);
    const auto before = cuda.launch(view);
    recorder.begin();
    EXPECT_EQ(message_of([&] { cuda.launch(view); }), "a launch in a capture comes after wait() for the one before");
    recorder.end();
    before.wait();
    recorder.begin();
    const auto launched = cuda.launch(view);
    EXPECT_EQ(message_of([&] { cuda.launch(view); }), "a detector's launches in a capture are one at most");
    EXPECT_EQ(message_of([&] { launched.wait(); }), "the capture that a launch was put into has not ended");
    recorder.end();
    EXPECT_EQ(message_of([&] { before.wait(); }),
              "there is nothing to wait for: another call has come after this launch");
    EXPECT_EQ(message_of([&] { launched.wait(); }), "wait() needs a replay of the captured launch before it");
    EXPECT_EQ(message_of([&] { launched.download(); }), "download() needs a wait() for meshes before it");
    recorder.replay();
    EXPECT_TRUE(shows(launched.wait(), view, nullptr, expected));
    EXPECT_EQ(message_of([&] { launched.wait(); }), "wait() needs a replay of the captured launch before it");
    recorder.replay();
    EXPECT_TRUE(shows(launched.wait(), view, nullptr, expected));
    EXPECT_TRUE(same_answer(launched.download(), expected));
    // Another call may move its lists, so it is over.
    EXPECT_TRUE(same_answer(cuda.find(mesh.view()), expected));
    EXPECT_EQ(message_of([&] { launched.wait(); }),
              "there is nothing to wait for: another call has come after this launch");
}

}  // namespace
}  // namespace crumple::test
