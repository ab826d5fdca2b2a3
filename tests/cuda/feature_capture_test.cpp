// Launches about features in a caller's capture: each replay of the caller's graph is a step. Plain CUDA: the CPU plays
// the device, or a device is there.

#include <gtest/gtest.h>

#include <vector>

#include "crumple/error.h"
#include "cuda/device_step.h"
#include "cuda/falling.h"
#include "cuda/recorder.h"
#include "error_of.h"

namespace crumple::test {
namespace {

/// Replays until the answer is complete: see CudaCapture.
template <class Wait>
auto answer_of(const Recorder& recorder, Wait wait) {
    for (int replay = 0;; ++replay) {
        recorder.replay();
        auto found = wait();
        if (found.complete || replay == 4) return found;
    }
}

TEST(CudaFeatureCapture, answers_each_replay) {
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda, .leaf_size = 150});
    DeviceStep<float> there(falling(500, 70));
    Recorder recorder;
    const MeshView view = there.view(recorder.stream());
    const Motion asked{.separation = 0.01};
    for (int call = 0; call < 2; ++call) {
        cuda.launch_impacts(view, there.end(), asked);
        cuda.wait_impacts();
    }
    recorder.begin();
    cuda.launch_impacts(view, there.end(), asked);
    recorder.end();
    EXPECT_STREQ(error_of([&] { cuda.wait_impacts(); }).what(),
                 "wait_impacts() needs a replay of the captured launch before it");
    int complete = 0;
    for (int frame = 70; frame < 94; frame += 4) {
        const MovingSoup<float> soup = falling(500, frame);
        there.move(soup);
        recorder.replay();
        EXPECT_EQ(error_of([&] { cuda.wait_near(); }).code, ErrorCode::invalid_argument);
        const DeviceImpacts& found = cuda.wait_impacts();
        if (!found.complete) continue;
        ++complete;
        EXPECT_TRUE(shows(found, cpu.find_impacts(soup.view(), soup.end_view(), asked))) << "frame " << frame;
    }
    EXPECT_GE(complete, 3) << "of 6 frames that look like the ones before";
}

TEST(CudaFeatureCapture, answers_every_question) {
    const MovingSoup<float> soup = falling(400, 88);
    const DeviceStep<float> there(soup);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = there.view(recorder.stream());
    const auto record = [&](auto launch, auto wait) {
        for (int call = 0; call < 2; ++call) launch(), wait();
        recorder.begin();
        launch();
        recorder.end();
        return answer_of(recorder, wait);
    };
    for (const MotionWants wants : {MotionWants::impacts, MotionWants::earliest, MotionWants::any})
        EXPECT_TRUE(shows(record([&] { cuda.launch_impacts(view, there.end(), {.wants = wants}); },
                                 [&] { return cuda.wait_impacts(); }),
                          cpu.find_impacts(soup.view(), soup.end_view(), {.wants = wants})));
    const Near near{.radius = 0.02, .rings = 1};
    EXPECT_TRUE(shows(record([&] { cuda.launch_near(view, near); }, [&] { return cuda.wait_near(); }),
                      cpu.find_near(soup.view(), near)));
    EXPECT_TRUE(
        shows(record([&] { cuda.launch_candidates(view, there.end()); }, [&] { return cuda.wait_candidates(); }),
              cpu.find_candidates(soup.view(), soup.end_view())));
}

// A graph cannot take other edges: the answer is not complete, and a call outside of it makes them anew.
TEST(CudaFeatureCapture, says_when_the_mesh_is_another) {
    MovingSoup<float> soup = falling(300, 88);
    const MeshView host = soup.view();
    DeviceStep<float> there(soup);
    DeviceArray<std::array<std::int32_t, 3>> triangles{std::span<const std::array<std::int32_t, 3>>(soup.triangles)};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    MeshView view = there.view(recorder.stream());
    view.triangles = rows_of_three(triangles.span()[0].data(), host.triangles.rows);
    const Near near{.radius = 0.5};
    const Nearby before = cpu.find_near(soup.view(), near);
    for (int call = 0; call < 2; ++call) cuda.launch_near(view, near), cuda.wait_near();
    recorder.begin();
    cuda.launch_near(view, near);
    recorder.end();
    EXPECT_TRUE(shows(answer_of(recorder, [&] { return cuda.wait_near(); }), before));
    std::swap(soup.triangles[3], soup.triangles[90]);
    triangles.set(soup.triangles);
    for (int replay = 0; replay < 2; ++replay) {
        recorder.replay();
        const DeviceNearby found = cuda.wait_near();
        EXPECT_FALSE(found.complete);
        EXPECT_EQ(found.count, 0);
    }
    std::swap(soup.triangles[3], soup.triangles[90]);
    triangles.set(soup.triangles);
    EXPECT_TRUE(shows(answer_of(recorder, [&] { return cuda.wait_near(); }), before));
    std::swap(soup.triangles[3], soup.triangles[90]);
    triangles.set(soup.triangles);
    cuda.launch_near(view, near);
    EXPECT_TRUE(shows(cuda.wait_near(), cpu.find_near(soup.view(), near)));
}

TEST(CudaFeatureCapture, needs_calls_before_it) {
    const MovingSoup<float> soup = falling(200, 88), other = falling(300, 88);
    const DeviceStep<float> there(soup), another(other);
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    Recorder recorder;
    const MeshView view = there.view(recorder.stream());
    const auto refused = [&] {
        recorder.begin();
        const Error error = error_of([&] { cuda.launch_impacts(view, there.end()); });
        recorder.end();
        return error.code == ErrorCode::invalid_argument;
    };
    EXPECT_TRUE(refused()) << "nothing came before";
    cuda.launch_near(view, {.radius = 0.01});
    cuda.wait_near();
    EXPECT_TRUE(refused()) << "another question";
    for (int call = 0; call < 2; ++call)
        cuda.launch_impacts(another.view(recorder.stream()), another.end()), cuda.wait_impacts();
    EXPECT_TRUE(refused()) << "another mesh";
    recorder.begin();
    EXPECT_EQ(error_of([&] { cuda.find_impacts(view, there.end()); }).code, ErrorCode::invalid_argument);
    recorder.end();
    cuda.launch_impacts(view, there.end());
    EXPECT_TRUE(shows(cuda.wait_impacts(), cpu.find_impacts(soup.view(), soup.end_view())));
}

}  // namespace
}  // namespace crumple::test
