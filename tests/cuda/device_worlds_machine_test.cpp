// Worlds under poses of the device, as the machine that plays it counts them.

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "crumple/error.h"
#include "cuda/device_world.h"
#include "cuda_on_cpu/machine/graph.h"
#include "cuda_on_cpu/machine/settings.h"
#include "error_of.h"
#include "memory_limit.h"
#include "worlds/compare_worlds.h"

namespace crumple::test {
namespace {

using cuda_on_cpu::settings;

class CudaMachineDeviceWorlds : public testing::Test {
   protected:
    void TearDown() override {
        settings() = {};
        settings().multiprocessors = 1;
    }
    /// Two bodies a world, which meet in every third one.
    void SetUp() override {
        for (int w = 0; w < 20; ++w)
            for (int b = 0; b < 2; ++b) {
                bodies_.push_back({.shape = b, .world = w});
                poses_.push_back({{1, 0, 0, b && w % 3 ? 0.5 + 1e-3 * w : 0, 0, 1, 0, 0, 0, 0, 1, 0}});
            }
    }
    World world() const { return {shapes_, bodies_, poses_}; }

    Soup<float> first_ = random_soup<float>(60, 0.3, 1), second_ = random_soup<float>(45, 0.3, 2);
    std::vector<Shape> shapes_{Shape(first_.view(), 1), Shape(second_.view(), 2)};
    std::vector<Body> bodies_;
    std::vector<Pose> poses_;
};

// One node more than a mesh on the device has: the kernel that names bodies.
TEST_F(CudaMachineDeviceWorlds, are_a_graph_of_few_nodes) {
    const DeviceWorld device(world());
    for (const Output wants : {Output::any_by_world, Output::pairs}) {
        Detector cuda({.backend = Backend::cuda});
        for (int frame = 0; frame < 5; ++frame) {
            cuda.launch(device.view(), {.output = wants}).wait();
        }
        EXPECT_EQ(cuda_on_cpu::graph_count().chain, 15u);
        EXPECT_EQ(cuda_on_cpu::graph_count().nodes, 17u);
        // No kernel beside the graph, and no memory.
        settings().launches_before_failure = settings().allocations_before_failure = 0;
        EXPECT_TRUE(cuda.launch(device.view(), {.output = wants}).wait().complete);
        settings().launches_before_failure = settings().allocations_before_failure = -1;
    }
}

TEST_F(CudaMachineDeviceWorlds, may_have_too_little_memory) {
    const DeviceWorld device(world());
    for (const Output wants : {Output::any, Output::any_by_world, Output::body_pairs, Output::contacts}) {
        SCOPED_TRACE(testing::Message() << "wants " << static_cast<int>(wants));
        const IntersectionQuery question{.output = wants};
        const Intersections expected = Detector({.backend = Backend::cpu}).find(world(), question);
        Detector free({.backend = Backend::cuda});
        std::int64_t limit = free.find(device.view(), question).statistics.peak_memory_bytes;
        int answers = 0;
        for (;; limit = limit * 2 / 3, ++answers) {
            Detector detector({.backend = Backend::cuda, .memory_limit = limit});
            try {
                const Intersections& found = detector.find(device.view(), question);
                ASSERT_TRUE(same_world_answer(found, expected)) << limit;
                EXPECT_LE(found.statistics.peak_memory_bytes, limit);
            } catch (const Error& error) {
                ASSERT_EQ(error.code, ErrorCode::memory_limit);
                break;
            }
        }
        EXPECT_GE(answers, 2);
    }
}

TEST_F(CudaMachineDeviceWorlds, may_run_out_of_memory_at_any_allocation_or_launch) {
    const DeviceWorld device(world());
    const Intersections expected = Detector({.backend = Backend::cpu}).find(world());
    for (int before = 0; before < 24; ++before) {
        SCOPED_TRACE(before);
        Detector first({.backend = Backend::cuda}), second({.backend = Backend::cuda});
        settings().allocations_before_failure = before;
        EXPECT_TRUE(same_world_answer(first.find(device.view()), expected));
        settings().allocations_before_failure = -1;
        settings().launches_before_failure = before;
        EXPECT_TRUE(same_world_answer(second.find(device.view()), expected));
        settings().launches_before_failure = -1;
    }
}

TEST_F(CudaMachineDeviceWorlds, say_what_limit_a_launch_needs) {
    const DeviceWorld device(world());
    const Intersections expected = Detector({.backend = Backend::cpu}).find(world());
    const auto answer = [&](Detector& detector) {
        return shows_world(detector.launch(device.view()).wait(), expected);
    };
    std::int64_t limit = 1 << 24;
    int answers = 0;
    for (;; limit = limit * 3 / 4, ++answers) {
        Detector detector({.backend = Backend::cuda, .memory_limit = limit});
        try {
            ASSERT_TRUE(answer(detector)) << limit;
        } catch (const Error& error) {
            ASSERT_EQ(error.code, ErrorCode::memory_limit);
            EXPECT_GT(error.bytes_needed, limit);
            sufficient_limit({.backend = Backend::cuda, .memory_limit = limit},
                             [&](Detector& enough) { EXPECT_TRUE(answer(enough)); });
            break;
        }
    }
    EXPECT_GE(answers, 1);
}

TEST_F(CudaMachineDeviceWorlds, are_told_when_the_device_lacks_memory) {
    const DeviceWorld device(world());
    const Intersections expected = Detector({.backend = Backend::cpu}).find(world());
    Detector cuda({.backend = Backend::cuda});
    for (int before = 0; before < 6; ++before) {
        settings().allocations_before_failure = before;
        try {
            EXPECT_TRUE(shows_world(cuda.launch(device.view()).wait(), expected)) << before;
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::device) << error.what();
        }
        settings().allocations_before_failure = -1;
    }
    EXPECT_TRUE(shows_world(cuda.launch(device.view()).wait(), expected));
}

TEST_F(CudaMachineDeviceWorlds, may_be_more_than_a_scene_holds) {
    const auto soup = random_soup<float>(1, 0.3, 1);
    const std::vector<Shape> shapes{Shape(soup.view(), 1)};
    std::vector<Body> bodies;
    std::vector<Pose> poses;
    constexpr int worlds = 65'540;
    for (int w = 0; w < worlds; ++w)
        for (int b = 0; b < 2; ++b) {
            bodies.push_back({.world = w});
            poses.push_back({{1, 0, 0, b && w % 1000 ? 9.0 : 0, 0, 1, 0, 0, 0, 0, 1, 0}});
        }
    const DeviceWorld device({shapes, bodies, poses});
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const IntersectionQuery question{.output = Output::any_by_world};
    EXPECT_TRUE(
        same_world_answer(cuda.find(device.view(), question), cpu.find(World{shapes, bodies, poses}, question)));
    EXPECT_STREQ(error_of([&] { cuda.launch(device.view(), question); }).what(),
                 "a launch takes at most 65535 worlds, and 16777216 triangles together");
}

}  // namespace
}  // namespace crumple::test
