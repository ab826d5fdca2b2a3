// Tests of queries that the cuda backend computes on the host in whole or in part: overlaps, containment and distances.
// Results equal those of the cpu backend byte by byte.

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

#include "backends/cuda/overlaps/device_overlaps.h"
#include "cuda/device_mesh.h"
#include "cuda/device_world.h"
#include "cuda_on_cpu/machine/launch.h"
#include "cuda_on_cpu/machine/settings.h"
#include "distances/compare_nearest.h"
#include "error_of.h"
#include "overlaps/closed_bodies.h"
#include "overlaps/joined_rows.h"

namespace crumple::test {
namespace {

/// Compares all queries of this file about one world; returns the number of rows.
std::int64_t compare(Detector& cuda, Detector& cpu, const World& there, const World& here) {
    std::int64_t rows = 0;
    for (const OverlapQuery& query :
         {OverlapQuery(), everything, OverlapQuery{.output = Output::any_by_world, .min_volume = 0.1},
          OverlapQuery{.output = Output::any}}) {
        const Overlaps& found = cuda.find(there, query);
        EXPECT_EQ(difference(found, cpu.find(here, query)), "");
        if (found.statistics.box_overlaps > 0) {
            EXPECT_EQ(found.statistics.backend, "cuda");
        }
        rows += found.count;
    }
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs}) {
        const IntersectionQuery query{.output = output, .containment = true};
        EXPECT_EQ(difference(cuda.find(there, query), cpu.find(here, query)), "");
    }
    for (const Output output : {Output::pairs, Output::nearest}) {
        const DistanceQuery query{.output = output};
        EXPECT_TRUE(same_nearest(cuda.find(there, query), cpu.find(here, query)));
    }
    return rows;
}

ClosedBodies bodies_of_worlds(unsigned seed) {
    ClosedBodies bodies = closed_bodies(seed, 6, seed % 2 == 0, seed % 2 != 0);
    for (std::size_t b = 0; b < 6; ++b) bodies.bodies[b].world = b == 5 ? -1 : static_cast<std::int32_t>(b / 2);
    return bodies;
}

TEST(CudaHostParts, queries_about_bodies_match_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = bodies_of_worlds(seed);
        rows += compare(cuda, cpu, bodies.view(), bodies.view());
        const DeviceWorld device(bodies.view());
        rows += compare(cuda, cpu, device.view(), bodies.view());
    }
    EXPECT_GT(rows, 20);
}

TEST(CudaHostParts, overlaps_in_blocks_match_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    for (unsigned seed = 0; seed < 4; ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = bodies_of_worlds(seed);
        const DeviceWorld device(bodies.view());
        Overlaps expected = cpu.find(bodies.view(), everything);
        expected.world_hit.clear(), expected.body_volume.clear(), expected.is_solid.clear();
        for (const World& world : {bodies.view(), device.view()}) {
            JoinedRows whole;
            cuda.stream(
                world, everything, [&](const Overlaps& block) { whole.add(block); }, 2);
            EXPECT_EQ(difference(whole.result, expected), "");
        }
    }
}

TEST(CudaHostParts, two_meshes_match_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 2, seed % 2 == 0, false);
        const Scene two{bodies.soups[0].view(), bodies.soups[1].view()};
        EXPECT_EQ(difference(cuda.find(two, everything), cpu.find(two, everything)), "");
        EXPECT_TRUE(same_nearest(cuda.find(two, DistanceQuery()), cpu.find(two, DistanceQuery())));
        const IntersectionQuery inside{.output = Output::body_pairs, .containment = true};
        const Intersections& found = cuda.find(two, inside);
        EXPECT_EQ(difference(found, cpu.find(two, inside)), "");
        rows += static_cast<std::int64_t>(found.bodies.size());
    }
    EXPECT_GT(rows, 3);
}

TEST(CudaHostParts, overlap_of_a_device_mesh_with_itself_matches_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    int overlapping = 0;
    for (unsigned seed = 0; seed < 6; ++seed) {
        const ClosedBodies bodies = closed_bodies(seed, 2, true, false);
        const Soup<double> both = joined(bodies.soups[0], bodies.soups[1]);
        const DeviceMesh device(both.view());
        const Overlaps& found = cuda.find(device.view(), everything);
        EXPECT_EQ(difference(found, cpu.find(both.view(), everything)), "") << seed;
        overlapping += found.any;
    }
    EXPECT_GT(overlapping, 0);
}

TEST(CudaHostParts, overlaps_from_parts_match_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const auto combined = [&](const Scene& scene, const OverlapQuery& query) {
        std::vector<Overlaps> found;
        for (const Part& part : cuda.partition(scene, query, 3)) {
            cuda.find(part, query);
            found.push_back(cuda.take_result<Overlaps>());
        }
        return cuda.combine(scene, query, found);
    };
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE(seed);
        const ClosedBodies bodies = closed_bodies(seed, 2, seed % 2 == 0, false);
        const Soup<double> both = joined(bodies.soups[0], bodies.soups[1]);
        const DeviceMesh device(both.view());
        const Overlaps itself = cpu.find(both.view(), everything);
        EXPECT_EQ(difference(combined(both.view(), everything), itself), "");
        EXPECT_EQ(difference(combined(device.view(), everything), itself), "");
        const Scene two{bodies.soups[0].view(), bodies.soups[1].view()};
        const Overlaps between = cpu.find(two, everything);
        EXPECT_EQ(difference(combined(two, everything), between), "");
        rows += itself.count + between.count;
    }
    EXPECT_GT(rows, 4);
}

TEST(CudaHostParts, several_devices_match_the_cpu) {
    cuda_on_cpu::settings().devices = 2;
    Options two;
    two.backend = Backend::cuda;
    two.devices = {0, 1};
    {
        Detector several(two), cpu({.backend = Backend::cpu});
        std::int64_t rows = 0;
        for (unsigned seed = 0; seed < 3; ++seed) {
            const ClosedBodies bodies = bodies_of_worlds(seed);
            rows += compare(several, cpu, bodies.view(), bodies.view());
        }
        EXPECT_GT(rows, 5);
    }
    cuda_on_cpu::settings().devices = 1;
}

/// Sets the number of pairs, or of faces, from which on the device is used.
class LeastOnDevice {
   public:
    LeastOnDevice(std::size_t& least, std::size_t value) : least_(least), before_(std::exchange(least, value)) {}
    LeastOnDevice(const LeastOnDevice&) = delete;
    LeastOnDevice& operator=(const LeastOnDevice&) = delete;
    ~LeastOnDevice() { least_ = before_; }

   private:
    std::size_t& least_;
    std::size_t before_;
};
constexpr std::size_t never = std::numeric_limits<std::size_t>::max();

// The pairs of all rows are decided by one kernel, and their segments summed by another one. Sums over many faces take
// a launch for each body.
TEST(CudaHostParts, overlaps_add_two_launches_for_all_pairs_and_one_for_each_sum_over_faces) {
    const ClosedBodies bodies = closed_bodies(3, 6, true, false);
    const auto launches = [&](std::size_t least_pairs, std::size_t least_faces) {
        const LeastOnDevice pairs(cuda::least_crossed_pairs, least_pairs), faces(cuda::least_summed_faces, least_faces);
        Detector cuda({.backend = Backend::cuda});
        for (int warm_up = 0; warm_up < 2; ++warm_up) cuda.find(bodies.view(), OverlapQuery());
        const std::size_t before = cuda_on_cpu::work_count().launches;
        EXPECT_GT(cuda.find(bodies.view(), OverlapQuery()).count, 1);
        return cuda_on_cpu::work_count().launches - before;
    };
    const std::size_t search = launches(never, never);
    EXPECT_EQ(launches(1, never), search + 2);
    EXPECT_GT(launches(1, 1), search + 2);
}

// The search is done when the failure happens: all of its memory is allocated, and all of its kernels have run.
TEST(CudaHostParts, missing_memory_or_a_failed_launch_leaves_the_sums_to_the_host) {
    const ClosedBodies bodies = closed_bodies(5, 4, true, false);
    Detector cpu({.backend = Backend::cpu});
    ASSERT_GT(cpu.find(bodies.view(), OverlapQuery()).count, 2);
    const auto matches = [&](Detector& cuda) {
        return difference(cuda.find(bodies.view(), OverlapQuery()), cpu.find(bodies.view(), OverlapQuery())).empty();
    };
    for (int before = 0; before < 5; ++before) {
        SCOPED_TRACE(before);
        Detector cuda({.backend = Backend::cuda});
        std::size_t launches = 0;
        {
            const LeastOnDevice pairs(cuda::least_crossed_pairs, never);
            for (int warm_up = 0; warm_up < 2; ++warm_up) EXPECT_TRUE(matches(cuda));
            const std::size_t begin = cuda_on_cpu::work_count().launches;
            EXPECT_TRUE(matches(cuda));
            launches = cuda_on_cpu::work_count().launches - begin;
        }
        cuda_on_cpu::settings().allocations_before_failure = before;
        EXPECT_TRUE(matches(cuda));
        cuda_on_cpu::settings().allocations_before_failure = -1;
        cuda_on_cpu::settings().launches_before_failure = static_cast<int>(launches) + before;
        EXPECT_TRUE(matches(cuda));
        cuda_on_cpu::settings().launches_before_failure = -1;
        EXPECT_TRUE(matches(cuda));
    }
}

TEST(CudaHostParts, overlaps_under_a_memory_limit_match_the_cpu_or_name_a_larger_limit) {
    const ClosedBodies bodies = closed_bodies(5, 4, true, false);
    Detector cpu({.backend = Backend::cpu});
    int results = 0;
    for (std::int64_t limit = 1 << 25;; limit = limit * 3 / 4, ++results) {
        Detector cuda({.backend = Backend::cuda, .memory_limit = limit});
        try {
            for (int call = 0; call < 2; ++call)
                ASSERT_EQ(difference(cuda.find(bodies.view(), everything), cpu.find(bodies.view(), everything)), "");
        } catch (const Error& error) {
            ASSERT_EQ(error.code, ErrorCode::memory_limit);
            EXPECT_GT(error.bytes_needed, limit);
            break;
        }
    }
    EXPECT_GE(results, 1);
}

/// Returns bodies whose coordinates are multiplied by `scale` and moved by `shift`.
ClosedBodies changed(ClosedBodies bodies, double scale, double shift) {
    for (auto& soup : bodies.soups)
        for (auto& p : soup.vertices)
            for (double& x : p) x = scale * x + shift;
    for (std::size_t b = 0; b < bodies.soups.size(); ++b) bodies.shapes[b] = Shape(bodies.soups[b].view());
    return bodies;
}

// Coordinates beyond 2^150 are left to the host. Those near 2^149 are not, nor are those that differ only in their last
// bits, so that many terms are uncertain or cancel.
TEST(CudaHostParts, overlaps_of_huge_tiny_and_distant_bodies_match_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    const OverlapQuery query{.self_overlaps = true, .curves = true};
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < 6; ++seed)
        for (const auto& [scale, shift] : {std::pair{0x1p147, 0.0},
                                           {0x1p160, 0.0},
                                           {0x1p-140, 0.0},
                                           {0x1p-200, 0.0},
                                           {1.0 / 3, 0x1p50},
                                           {0x1p-49, 1.0},
                                           {1.0 / 3, 100.0}}) {
            SCOPED_TRACE(seed);
            SCOPED_TRACE(scale);
            ClosedBodies bodies = changed(closed_bodies(seed, 4, seed % 2 == 0, false), scale, shift);
            const Overlaps& found = cuda.find(bodies.view(), query);
            EXPECT_EQ(difference(found, cpu.find(bodies.view(), query)), "");
            rows += found.count;
        }
    EXPECT_GT(rows, 40);
}

TEST(CudaHostParts, mirrored_bodies_match_the_cpu) {
    Detector cuda({.backend = Backend::cuda}), cpu({.backend = Backend::cpu});
    for (unsigned seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE(seed);
        ClosedBodies bodies = closed_bodies(seed, 4, seed % 2 == 0, false);
        bodies.poses[1] = {{-1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0}};
        EXPECT_EQ(difference(cuda.find(bodies.view(), everything), cpu.find(bodies.view(), everything)), "");
    }
}

TEST(CudaHostParts, containment_of_device_meshes_is_rejected) {
    Detector cuda({.backend = Backend::cuda});
    const ClosedBodies bodies = closed_bodies(1, 2, true, false);
    const DeviceMesh a(bodies.soups[0].view()), b(bodies.soups[1].view());
    const IntersectionQuery query{.output = Output::any, .containment = true};
    EXPECT_FALSE(cuda.supports(Scene{a.view(), b.view()}, query));
    EXPECT_STREQ(error_of([&] {
                     cuda.find(Scene{a.view(), b.view()}, query);
                 }).what(),
                 "containment needs meshes in host memory");
    EXPECT_STREQ(error_of([&] {
                     cuda.find(Scene{a.view(), b.view()}, OverlapQuery());
                 }).what(),
                 "two meshes must be in host memory, except for intersections");
}

}  // namespace
}  // namespace crumple::test
