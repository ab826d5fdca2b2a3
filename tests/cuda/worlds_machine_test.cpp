// Tests of worlds searched side by side on an emulated device, which counts launches: the number of launches, and
// worlds that do not fit into memory.

#include <gtest/gtest.h>

#include <span>
#include <utility>
#include <vector>

#include "crumple/error.h"
#include "cuda_on_cpu/machine/settings.h"
#include "memory_limit.h"
#include "worlds/compare_worlds.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

using cuda_on_cpu::settings;

class CudaMachineWorlds : public testing::Test {
   protected:
    void TearDown() override {
        settings() = {};
        settings().multiprocessors = 1;
    }

    /// Makes worlds of two bodies, random soups in the unit cube. In two of three worlds the second body is moved by at
    /// least half a unit, so that fewer pairs collide, or none. Every seventh world has no bodies.
    explicit CudaMachineWorlds(int worlds = 40) {
        for (int w = 0; w < worlds; ++w) {
            if (w % 7 == 5) continue;
            for (int b = 0; b < 2; ++b) {
                bodies_.push_back({.shape = b, .world = w});
                poses_.push_back({{1, 0, 0, b && w % 3 ? 0.5 + 1e-3 * w : 0, 0, 1, 0, 0, 0, 0, 1, 0}});
            }
        }
    }
    World world(std::size_t bodies) const {
        return {shapes_, std::span(bodies_).first(bodies), std::span(poses_).first(bodies)};
    }
    World world() const { return world(bodies_.size()); }

    /// Returns the number of kernels that a new detector launches for the query.
    static int launches(const World& world, const IntersectionQuery& query) {
        Detector detector({.backend = Backend::cuda});
        constexpr int many = 1 << 30;
        settings().launches_before_failure = many;
        detector.find(world, query);
        return many - std::exchange(settings().launches_before_failure, -1);
    }

    Soup<float> first_ = random_soup<float>(60, 0.3, 1), second_ = random_soup<float>(45, 0.3, 2);
    std::vector<Shape> shapes_{Shape(first_.view()), Shape(second_.view())};
    std::vector<Body> bodies_;
    std::vector<Pose> poses_;
};

TEST_F(CudaMachineWorlds, number_of_launches_does_not_depend_on_number_of_worlds) {
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs, Output::pairs}) {
        const IntersectionQuery query{.output = output};
        EXPECT_EQ(launches(world(), query), launches(world(4), query)) << "wants " << static_cast<int>(output);
    }
    Detector detector({.backend = Backend::cuda});
    EXPECT_EQ(detector.find(world()).statistics.leaves, 35) << "a leaf each world";
}

TEST_F(CudaMachineWorlds, limited_search_gives_same_result_or_names_larger_limit) {
    for (const Output output :
         {Output::any, Output::any_by_world, Output::body_pairs, Output::pairs, Output::contacts}) {
        SCOPED_TRACE(testing::Message() << "wants " << static_cast<int>(output));
        const IntersectionQuery query{.output = output};
        const Intersections expected = Detector({.backend = Backend::cpu}).find(world(), query);
        const int one_pass = launches(world(), query);
        Detector free({.backend = Backend::cuda});
        std::int64_t limit = free.find(world(), query).statistics.peak_memory_bytes;
        int results = 0;
        for (;; limit = limit * 2 / 3, ++results) {
            Detector detector({.backend = Backend::cuda, .memory_limit = limit});
            try {
                const Intersections& found = detector.find(world(), query);
                ASSERT_TRUE(same_world_result(found, expected)) << limit;
                EXPECT_LE(found.statistics.peak_memory_bytes, limit);
            } catch (const Error& error) {
                ASSERT_EQ(error.code, ErrorCode::memory_limit);
                sufficient_limit({.backend = Backend::cuda, .memory_limit = limit}, [&](Detector& enough) {
                    EXPECT_TRUE(same_world_result(enough.find(world(), query), expected));
                });
                break;
            }
        }
        EXPECT_GE(results, 3) << "of " << one_pass << " kernels";
    }
}

TEST_F(CudaMachineWorlds, failed_allocation_or_launch_does_not_change_result) {
    for (const Output output : {Output::any_by_world, Output::contacts}) {
        const IntersectionQuery query{.output = output};
        const Intersections expected = Detector({.backend = Backend::cpu}).find(world(), query);
        for (int before = 0; before < 30; ++before) {
            SCOPED_TRACE(testing::Message() << "wants " << static_cast<int>(output) << ", after " << before);
            Detector first({.backend = Backend::cuda}), second({.backend = Backend::cuda});
            settings().allocations_before_failure = before;
            EXPECT_TRUE(same_world_result(first.find(world(), query), expected));
            settings().allocations_before_failure = -1;
            settings().launches_before_failure = before;
            EXPECT_TRUE(same_world_result(second.find(world(), query), expected));
            settings().launches_before_failure = -1;
        }
    }
}

}  // namespace
}  // namespace crumple::test
