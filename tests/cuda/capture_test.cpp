// Tests of launches that a caller captures: each replay of the caller's graph runs the query. Calls only the CUDA
// runtime, so that it runs on a device or on one that the CPU emulates.

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
#include "cuda/downloaded_results.h"
#include "cuda/recorder.h"
#include "error_of.h"
#include "halves.h"
#include "soups.h"

namespace crumple::test {
namespace {

void warm_up(Detector& cuda, const MeshView& mesh, const IntersectionQuery& query = {}) {
    for (int call = 0; call < 2; ++call) cuda.launch(mesh, query).wait();
}

std::string message_of(auto call) { return error_of(call).what(); }

TEST(CudaCapture, each_complete_replay_gives_the_current_result) {
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
                EXPECT_TRUE(same_result(launched.download(), expected)) << "frame " << frame;
            }
            EXPECT_GE(complete, 4) << "of 8 frames that look like the ones before";
        }
    }
}

TEST(CudaCapture, wait_gives_the_result_of_the_last_replay) {
    const io::TriangleMesh mesh = cloth(600, 93), earlier = cloth(600, 80);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    ASSERT_NE(pairs_of(cpu.find(earlier.view())), pairs_of(cpu.find(mesh.view())));
    DeviceMesh device(mesh.view());
    Recorder recorder;
    const MeshView view = recorder.on(device.view());
    for (int call = 0; call < 2; ++call) cuda.find(device.view());  // instead of launches: these calls list pairs, too
    recorder.begin();
    const auto launched = cuda.launch(view);
    recorder.end();
    device.set_vertices(earlier.view());
    recorder.replay();  // its result is not read
    device.set_vertices(mesh.view());
    for (int replay = 0; replay < 3; ++replay) recorder.replay();
    EXPECT_TRUE(shows(launched.wait(), view, nullptr, cpu.find(mesh.view())));
}

// Pairs that expansions cannot represent, and contacts of coplanar triangles, are computed by the host in wait().
TEST(CudaCapture, host_decides_pairs_that_the_device_cannot) {
    const IntersectionQuery query{.output = Output::contacts};
    std::int64_t rational = 0, unresolved = 0;
    for (const NamedMesh& scene : hard_soups()) {
        SCOPED_TRACE(scene.name);
        const DeviceMesh device(scene.mesh.view());
        Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
        const Intersections& expected = cpu.find(scene.mesh.view(), query);
        Recorder recorder;
        const MeshView view = recorder.on(device.view());
        for (int capture = 0; capture < 2; ++capture) {
            const DeviceIntersections found =
                capture_until_complete(recorder, [&] { return cuda.launch(view, query); });
            EXPECT_TRUE(shows(found, view, nullptr, expected));
            rational += found.statistics.rational_contacts;
            unresolved += found.statistics.rational_tests;
        }
    }
    EXPECT_GT(rational, 0);
    EXPECT_GT(unresolved, 0);
}

TEST(CudaCapture, captured_launch_of_meshes_on_two_streams_matches_the_cpu) {
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
              "the streams of both meshes must be in the same capture, or in none");
    check(cudaEventRecord(fork, recorder.stream()));
    check(cudaStreamWaitEvent(other.stream(), fork, 0));
    const auto launched = cuda.launch({first, second});
    recorder.end();
    EXPECT_TRUE(shows(replay_until_complete(recorder, launched), half.a, &half.b, cpu.find({half.a, half.b})));
    check(cudaEventDestroy(fork));
}

// The legacy stream cannot be used while a blocking stream captures. The call is rejected before it uses the stream, so
// that the capture remains valid.
TEST(CudaCapture, legacy_stream_beside_a_captured_one_is_rejected) {
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
        const std::string refused = "the streams of both meshes must be in the same capture, or in none";
        EXPECT_EQ(message_of([&] { cuda.launch({a, b}); }), refused);
        EXPECT_EQ(message_of([&] { cuda.launch({b, a}); }), refused);
        cudaGraph_t graph = nullptr;
        EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
        if (graph) check(cudaGraphDestroy(graph));
    }
    check(cudaStreamDestroy(stream));
}

TEST(CudaCapture, capture_survives_the_end_of_a_detector) {
    const DeviceMesh device(cloth(300, 93).view());
    const DeviceBytes bytes(std::vector<std::byte>(1));
    std::optional<Detector> cuda(std::in_place, Options{.backend = Backend::cuda});
    for (int call = 0; call < 3; ++call) cuda->launch(device.view()).wait();
    cuda->launch(device.view());  // the detector's destructor waits for it
    Recorder recorder;
    recorder.begin();
    check(cudaMemsetAsync(bytes.data(), 7, 1, recorder.stream()));
    cuda.reset();
    recorder.end();
    recorder.replay();
    EXPECT_EQ(to_host(static_cast<const unsigned char*>(bytes.data()), 1), std::vector<unsigned char>{7});
}

// A scene that changes suddenly needs longer lists than the graph has. A call outside of the capture allocates them.
TEST(CudaCapture, incomplete_replay_reports_a_lower_bound_of_pairs_needed_and_the_graph_stays_usable) {
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
        EXPECT_EQ(message_of([&] { launched.download(); }),
                  "download() needs a complete result; call launch() outside of the capture, and capture again");
    }
    // The graph still works for scenes that fit. After a sudden change, the first replay may be incomplete, but it
    // warm-starts the next one.
    device.set_vertices(sparse.view());
    EXPECT_TRUE(shows(replay_until_complete(recorder, launched), view, nullptr, cpu.find(sparse.view())));
    device.set_vertices(dense.view());
    warm_up(cuda, view);
    EXPECT_EQ(message_of([&] { launched.wait(); }),
              "wait() is too late: another call of the detector came after this launch");
    warm_up(cuda, view);
    recorder.begin();
    const auto again = cuda.launch(view);
    recorder.end();
    EXPECT_TRUE(shows(replay_until_complete(recorder, again), view, nullptr, cpu.find(dense.view())));
}

TEST(CudaCapture, replay_of_invalid_input_is_an_error_and_later_replays_are_right) {
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
        ASSERT_TRUE(replay_until_complete(recorder, launched).complete);
        EXPECT_TRUE(same_result(launched.download(), cpu.find(good.view())));
    }
}

// A rejected launch affects neither the capture nor the detector's state.
TEST(CudaCapture, launch_without_warm_up_is_rejected_and_capture_continues) {
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

TEST(CudaCapture, calls_in_the_wrong_order_are_rejected) {
    const io::TriangleMesh mesh = cloth(300, 93);
    const DeviceMesh device(mesh.view());
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = recorder.on(device.view());
    const Intersections expected = cpu.find(mesh.view());
    warm_up(cuda, view);
    const auto before = cuda.launch(view);
    recorder.begin();
    EXPECT_EQ(message_of([&] { cuda.launch(view); }),
              "launches are in flight; call wait() for them before a launch in a capture");
    recorder.end();
    before.wait();
    recorder.begin();
    const auto launched = cuda.launch(view);
    EXPECT_EQ(message_of([&] { cuda.launch(view); }), "a capture can have only one launch of a detector");
    EXPECT_EQ(message_of([&] { launched.wait(); }),
              "a capture with a launch of this detector has not ended; end it before this call");
    recorder.end();
    EXPECT_EQ(message_of([&] { before.wait(); }),
              "wait() is too late: another call of the detector came after this launch");
    EXPECT_EQ(message_of([&] { launched.wait(); }), "wait() needs a replay of the captured launch before it");
    EXPECT_EQ(message_of([&] { launched.download(); }),
              "download() is for launches of meshes, and must come right after their wait()");
    recorder.replay();
    EXPECT_TRUE(shows(launched.wait(), view, nullptr, expected));
    EXPECT_EQ(message_of([&] { launched.wait(); }), "wait() needs a replay of the captured launch before it");
    recorder.replay();
    EXPECT_TRUE(shows(launched.wait(), view, nullptr, expected));
    EXPECT_TRUE(same_result(launched.download(), expected));
    // Another call may reallocate the lists, and ends the captured launch.
    EXPECT_TRUE(same_result(cuda.find(mesh.view()), expected));
    EXPECT_EQ(message_of([&] { launched.wait(); }),
              "wait() is too late: another call of the detector came after this launch");
}

}  // namespace
}  // namespace crumple::test
