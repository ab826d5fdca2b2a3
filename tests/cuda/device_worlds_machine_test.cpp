// Tests of worlds with poses on an emulated device, which counts graphs, launches and allocations.

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
    /// Makes 20 worlds of two bodies, random soups in the unit cube. In two of three worlds the second body is moved by
    /// at least half a unit, so that fewer pairs collide, or none.
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

// The graph has one node more than that of a mesh on the device: the kernel that finds the bodies of pairs.
TEST_F(CudaMachineDeviceWorlds, graph_of_a_launch_has_17_nodes) {
    const DeviceWorld device(world());
    for (const Output output : {Output::any_by_world, Output::pairs}) {
        Detector cuda({.backend = Backend::cuda});
        for (int frame = 0; frame < 5; ++frame) {
            cuda.launch(device.view(), {.output = output}).wait();
        }
        EXPECT_EQ(cuda_on_cpu::graph_count().chain, 15u);
        EXPECT_EQ(cuda_on_cpu::graph_count().nodes, 17u);
        // A launch needs neither kernels outside of the graph nor new memory.
        settings().launches_before_failure = settings().allocations_before_failure = 0;
        EXPECT_TRUE(cuda.launch(device.view(), {.output = output}).wait().complete);
        settings().launches_before_failure = settings().allocations_before_failure = -1;
    }
}

TEST_F(CudaMachineDeviceWorlds, find_gives_same_result_or_memory_limit_error) {
    const DeviceWorld device(world());
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs, Output::contacts}) {
        SCOPED_TRACE(testing::Message() << "wants " << static_cast<int>(output));
        const IntersectionQuery query{.output = output};
        const Intersections expected = Detector({.backend = Backend::cpu}).find(world(), query);
        Detector free({.backend = Backend::cuda});
        std::int64_t limit = free.find(device.view(), query).statistics.peak_memory_bytes;
        int results = 0;
        for (;; limit = limit * 2 / 3, ++results) {
            Detector detector({.backend = Backend::cuda, .memory_limit = limit});
            try {
                const Intersections& found = detector.find(device.view(), query);
                ASSERT_TRUE(same_world_result(found, expected)) << limit;
                EXPECT_LE(found.statistics.peak_memory_bytes, limit);
            } catch (const Error& error) {
                ASSERT_EQ(error.code, ErrorCode::memory_limit);
                break;
            }
        }
        EXPECT_GE(results, 2);
    }
}

TEST_F(CudaMachineDeviceWorlds, failed_allocation_or_launch_does_not_change_result) {
    const DeviceWorld device(world());
    const Intersections expected = Detector({.backend = Backend::cpu}).find(world());
    for (int before = 0; before < 24; ++before) {
        SCOPED_TRACE(before);
        Detector first({.backend = Backend::cuda}), second({.backend = Backend::cuda});
        settings().allocations_before_failure = before;
        EXPECT_TRUE(same_world_result(first.find(device.view()), expected));
        settings().allocations_before_failure = -1;
        settings().launches_before_failure = before;
        EXPECT_TRUE(same_world_result(second.find(device.view()), expected));
        settings().launches_before_failure = -1;
    }
}

TEST_F(CudaMachineDeviceWorlds, memory_limit_error_of_a_launch_names_no_more_than_it_needs) {
    const DeviceWorld device(world());
    const Intersections expected = Detector({.backend = Backend::cpu}).find(world());
    const auto launch_matches = [&](Detector& detector) {
        return shows_world(detector.launch(device.view()).wait(), expected);
    };
    std::int64_t limit = 1 << 24;
    int results = 0;
    for (;; limit = limit * 3 / 4, ++results) {
        Detector detector({.backend = Backend::cuda, .memory_limit = limit});
        try {
            ASSERT_TRUE(launch_matches(detector)) << limit;
        } catch (const Error& error) {
            ASSERT_EQ(error.code, ErrorCode::memory_limit);
            EXPECT_GT(error.bytes_needed, limit);
            sufficient_limit(
                {.backend = Backend::cuda, .memory_limit = limit},
                [&](Detector& enough) { EXPECT_TRUE(launch_matches(enough)); }, 4);
            break;
        }
    }
    EXPECT_GE(results, 1);
}

TEST_F(CudaMachineDeviceWorlds, failed_allocation_in_a_launch_gives_result_or_device_error) {
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

TEST_F(CudaMachineDeviceWorlds, find_accepts_more_worlds_than_a_launch) {
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
    const IntersectionQuery query{.output = Output::any_by_world};
    EXPECT_TRUE(same_world_result(cuda.find(device.view(), query), cpu.find(World{shapes, bodies, poses}, query)));
    EXPECT_STREQ(error_of([&] { cuda.launch(device.view(), query); }).what(),
                 "a launch supports at most 65535 worlds, and 16777216 triangles in all of them; find() supports more");
}

}  // namespace
}  // namespace crumple::test
