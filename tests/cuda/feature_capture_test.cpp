// Tests of launches of feature queries in a caller's capture: each replay of the caller's graph is a step. Calls only
// the CUDA runtime, so that it runs on a device or on one that the CPU emulates.

#include <gtest/gtest.h>

#include <vector>

#include "crumple/error.h"
#include "cuda/device_step.h"
#include "cuda/falling.h"
#include "cuda/recorder.h"
#include "error_of.h"

namespace crumple::test {
namespace {

TEST(CudaFeatureCapture, each_complete_replay_gives_the_current_result) {
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda, .leaf_size = 150});
    DeviceStep<float> on_device(falling(500, 70));
    Recorder recorder;
    const MeshView view = on_device.view(recorder.stream());
    const ImpactQuery query{.min_distance = 0.01};
    cuda.launch(view.moving_to(on_device.end()), query).wait();
    const auto before = cuda.launch(view.moving_to(on_device.end()), query);
    before.wait();
    recorder.begin();
    const auto launched = cuda.launch(view.moving_to(on_device.end()), query);
    recorder.end();
    EXPECT_STREQ(error_of([&] { launched.wait(); }).what(), "wait() needs a replay of the captured launch before it");
    int complete = 0;
    for (int frame = 70; frame < 94; frame += 4) {
        const MovingSoup<float> soup = falling(500, frame);
        on_device.move(soup);
        recorder.replay();
        EXPECT_EQ(error_of([&] { before.wait(); }).code, ErrorCode::invalid_argument);
        const DeviceImpacts& found = launched.wait();
        if (!found.complete) continue;
        ++complete;
        EXPECT_TRUE(shows(found, cpu.find(soup.view().moving_to(soup.end_view()), query))) << "frame " << frame;
    }
    EXPECT_GE(complete, 3) << "of 6 frames that look like the ones before";
}

TEST(CudaFeatureCapture, captured_impacts_proximities_and_candidates_match_the_cpu) {
    const MovingSoup<float> soup = falling(400, 88);
    const DeviceStep<float> on_device(soup);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = on_device.view(recorder.stream());
    const auto record = [&](const MeshView& mesh, const auto& query) {
        return capture_until_complete(recorder, [&] { return cuda.launch(mesh, query); });
    };
    for (const Output output : {Output::pairs, Output::first, Output::any})
        EXPECT_TRUE(shows(record(view.moving_to(on_device.end()), ImpactQuery{.output = output}),
                          cpu.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.output = output})));
    const ProximityQuery near{.radius = 0.02, .rings = 1};
    EXPECT_TRUE(shows(record(view, near), cpu.find(soup.view(), near)));
    EXPECT_TRUE(shows(record(view.moving_to(on_device.end()), CandidateQuery()),
                      cpu.find(soup.view().moving_to(soup.end_view()), CandidateQuery())));
}

// A graph has the edges of the triangles at the time of the capture. If the triangles change, the result is incomplete
// until a call outside of the capture lists the new edges.
TEST(CudaFeatureCapture, changed_triangles_make_a_replay_incomplete) {
    MovingSoup<float> soup = falling(300, 88);
    const MeshView host = soup.view();
    DeviceStep<float> on_device(soup);
    DeviceArray<std::array<std::int32_t, 3>> triangles{std::span<const std::array<std::int32_t, 3>>(soup.triangles)};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    MeshView view = on_device.view(recorder.stream());
    view.triangles = rows_of_three(triangles.span()[0].data(), host.triangles.rows);
    const ProximityQuery near{.radius = 0.5};
    const Proximities before = cpu.find(soup.view(), near);
    for (int call = 0; call < 2; ++call) cuda.launch(view, near).wait();
    recorder.begin();
    const auto launched = cuda.launch(view, near);
    recorder.end();
    EXPECT_TRUE(shows(replay_until_complete(recorder, launched), before));
    std::swap(soup.triangles[3], soup.triangles[90]);
    triangles.set(soup.triangles);
    for (int replay = 0; replay < 2; ++replay) {
        recorder.replay();
        const DeviceProximities found = launched.wait();
        EXPECT_FALSE(found.complete);
        EXPECT_EQ(found.count, 0);
    }
    std::swap(soup.triangles[3], soup.triangles[90]);
    triangles.set(soup.triangles);
    EXPECT_TRUE(shows(replay_until_complete(recorder, launched), before));
    std::swap(soup.triangles[3], soup.triangles[90]);
    triangles.set(soup.triangles);
    EXPECT_TRUE(shows(cuda.launch(view, near).wait(), cpu.find(soup.view(), near)));
}

TEST(CudaFeatureCapture, launch_in_a_capture_is_rejected_without_calls_before_it) {
    const MovingSoup<float> soup = falling(200, 88), other = falling(300, 88);
    const DeviceStep<float> on_device(soup), another(other);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = on_device.view(recorder.stream());
    const auto refused = [&] {
        recorder.begin();
        const Error error = error_of([&] { cuda.launch(view.moving_to(on_device.end()), ImpactQuery()); });
        recorder.end();
        return error.code == ErrorCode::invalid_argument;
    };
    EXPECT_TRUE(refused()) << "nothing came before";
    cuda.launch(view, ProximityQuery{.radius = 0.01}).wait();
    EXPECT_TRUE(refused()) << "another question";
    for (int call = 0; call < 2; ++call)
        cuda.launch(another.view(recorder.stream()).moving_to(another.end()), ImpactQuery()).wait();
    EXPECT_TRUE(refused()) << "another mesh";
    recorder.begin();
    EXPECT_EQ(error_of([&] { cuda.find(view.moving_to(on_device.end()), ImpactQuery()); }).code,
              ErrorCode::invalid_argument);
    recorder.end();
    EXPECT_TRUE(shows(cuda.launch(view.moving_to(on_device.end()), ImpactQuery()).wait(),
                      cpu.find(soup.view().moving_to(soup.end_view()), ImpactQuery())));
}

}  // namespace
}  // namespace crumple::test
