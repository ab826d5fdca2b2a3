// Counts of the work of kernels whose work is known. This file is compiled with the options that count steps.

#include <cuda_profiler_api.h>

#include <string>

#include "cuda_on_cpu/machine/counts.h"
#include "cuda_on_cpu/machine/sanitizers.h"
#include "cuda_on_cpu/tests/fixture.h"
#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using cuda_on_cpu::KernelCounts;
using cuda_on_cpu::Order;
using cuda_on_cpu::settings;
using portable::Array;
using portable::check;
using portable::launch;

class MachineCounts : public cuda_on_cpu::FreshSettings {
   protected:
    void SetUp() override {
        FreshSettings::SetUp();
        if (cuda_on_cpu::thread_sanitizer) GTEST_SKIP() << "counting is not made for ThreadSanitizer";
    }
};

/// Returns the counts of the only kernel that is launched once by f().
template <class F>
KernelCounts counts_of(F f) {
    check(cudaDeviceSynchronize());
    cuda_on_cpu::start_counting();
    f();
    check(cudaDeviceSynchronize());
    const auto all = cuda_on_cpu::stop_counting();
    EXPECT_EQ(all.size(), 1u);
    return all.empty() ? KernelCounts{} : all[0];
}

/// Runs f() in all orders of threads. Counts do not depend on them.
template <class F>
void in_each_order(F f) {
    for (const Order order : {Order::forward, Order::reverse, Order::random}) {
        settings().order = order;
        f();
    }
}

__global__ void one_address(unsigned* sum) { atomicAdd(sum, 1u); }
__global__ void one_address_a_lane(unsigned* sums) { atomicAdd(&sums[threadIdx.x % 32], 1u); }
__global__ void some_lanes_twice(unsigned* sums) {
    for (unsigned k = 0; k < (threadIdx.x % 32 < 5 ? 2u : 1u); ++k) atomicAdd(&sums[k], 1u);
}

TEST_F(MachineCounts, lanes_that_add_to_one_address_make_one_instruction_of_a_warp) {
    const Array<unsigned> sums(std::vector<unsigned>(32));
    in_each_order([&] {
        const KernelCounts counts = counts_of([&] { launch(one_address, 3, 64, 0, sums.data()); });
        EXPECT_EQ(counts.launches, 1u);
        EXPECT_EQ(counts.warps, 6u);
        EXPECT_EQ(counts.global.lanes, 192u);
        EXPECT_EQ(counts.global.instructions, 6u);
        EXPECT_EQ(counts.global.parts, 6u);
        EXPECT_EQ(counts.addresses, 1u);
        EXPECT_EQ(counts.most_at_one, 192u);
        EXPECT_EQ(counts.most_instructions, 6u);
        EXPECT_EQ(counts.shared.lanes, 0u);
    });
}

TEST_F(MachineCounts, lanes_that_add_to_different_addresses_make_as_many_parts) {
    const Array<unsigned> sums(std::vector<unsigned>(32));
    in_each_order([&] {
        const KernelCounts counts = counts_of([&] { launch(one_address_a_lane, 3, 64, 0, sums.data()); });
        EXPECT_EQ(counts.global.lanes, 192u);
        EXPECT_EQ(counts.global.instructions, 6u);
        EXPECT_EQ(counts.global.parts, 192u);
        EXPECT_EQ(counts.addresses, 32u);
        EXPECT_EQ(counts.most_at_one, 6u);
        EXPECT_EQ(counts.most_instructions, 6u);
    });
}

TEST_F(MachineCounts, repeated_atomic_of_a_lane_is_an_instruction_of_its_own) {
    const Array<unsigned> sums(std::vector<unsigned>(2));
    in_each_order([&] {
        const KernelCounts counts = counts_of([&] { launch(some_lanes_twice, 1, 32, 0, sums.data()); });
        EXPECT_EQ(counts.global.lanes, 37u);
        EXPECT_EQ(counts.global.instructions, 2u);
        EXPECT_EQ(counts.most_at_one, 32u);
    });
}

struct Sum {
    unsigned value;
};
__global__ void by_block(unsigned* sum) {
    Sum& shared = portable::dynamic_shared<Sum>();
    if (threadIdx.x == 0) shared.value = 0;
    __syncthreads();
    atomicAdd(&shared.value, 1u);
    __syncthreads();
    if (threadIdx.x == 0) atomicAdd(sum, shared.value);
}

TEST_F(MachineCounts, shared_memory_is_counted_apart) {
    const Array<unsigned> sum(std::vector<unsigned>(1));
    in_each_order([&] {
        const KernelCounts counts = counts_of([&] { launch(by_block, 5, 96, sizeof(Sum), sum.data()); });
        EXPECT_EQ(counts.shared.lanes, 5 * 96u);
        EXPECT_EQ(counts.shared.instructions, 5 * 3u);
        EXPECT_EQ(counts.global.lanes, 5u);
        EXPECT_EQ(counts.most_at_one, 5u);
        EXPECT_EQ(counts.meetings, 5 * 3 * 2u) << "two barriers for each of three warps of each block";
    });
}

__global__ void votes(unsigned* out, unsigned times) {
    unsigned ballots = 0;
    for (unsigned i = 0; i < times; ++i) ballots += __ballot_sync(~0u, threadIdx.x % 2 == 0);
    out[threadIdx.x] = ballots;
}

TEST_F(MachineCounts, votes_are_counted_once_for_a_warp) {
    const Array<unsigned> out(64);
    in_each_order([&] { EXPECT_EQ(counts_of([&] { launch(votes, 1, 64, 0, out.data(), 7u); }).meetings, 14u); });
}

// Lane i goes through the loop `least` + i * `more` times.
__global__ void uneven(volatile unsigned* out, unsigned least, unsigned more) {
    for (unsigned i = 0; i < least + more * (threadIdx.x % 32); ++i) out[threadIdx.x] = i;
}
KernelCounts steps_of(unsigned threads, unsigned least, unsigned more) {
    const Array<unsigned> out(64);
    return counts_of([&] { launch(uneven, 1, threads, 0, out.data(), least, more); });
}

TEST_F(MachineCounts, steps_of_a_warp_are_those_of_its_longest_lane) {
    in_each_order([&] {
        // The steps of one iteration, without those before and after the loop.
        const std::uint64_t one = steps_of(32, 200, 0).warp_steps - steps_of(32, 199, 0).warp_steps;
        ASSERT_GE(one, 1u);
        const KernelCounts even = steps_of(64, 100, 0), skew = steps_of(64, 100, 10);
        EXPECT_EQ(even.lane_steps, 32 * even.warp_steps);
        EXPECT_EQ(skew.warp_steps - even.warp_steps, 2 * one * 310) << "lane 31 of both warps";
        EXPECT_EQ(skew.lane_steps - even.lane_steps, 2 * one * 10 * (31 * 32 / 2)) << "all lanes";
    });
}

// Even lanes, then odd lanes run the same loop. With a meeting after each of the two runs, they cannot share a step.
__global__ void in_two_runs(volatile unsigned* out, unsigned work, bool apart) {
    for (unsigned run = 0; run < 2; ++run) {
        if (threadIdx.x % 2 == run)
            for (unsigned i = 0; i < work; ++i) out[threadIdx.x] = i;
        if (apart) __syncwarp();
    }
}

TEST_F(MachineCounts, lanes_share_no_step_across_a_meeting) {
    const Array<unsigned> out(32);
    in_each_order([&] {
        const auto steps = [&](unsigned work, bool apart) {
            return counts_of([&] { launch(in_two_runs, 1, 32, 0, out.data(), work, apart); });
        };
        const KernelCounts together = steps(2000, false), apart = steps(2000, true), idle = steps(1000, true);
        EXPECT_EQ(apart.lane_steps - idle.lane_steps, 16 * (apart.warp_steps - idle.warp_steps)) << "half of the lanes";
        EXPECT_GT(apart.warp_steps, 19 * together.warp_steps / 10);
    });
}

TEST_F(MachineCounts, launches_of_a_kernel_are_added_up_while_counting_is_on) {
    const Array<unsigned> sums(std::vector<unsigned>(32));
    launch(one_address, 1, 32, 0, sums.data());
    check(cudaDeviceSynchronize());
    cuda_on_cpu::start_counting();
    for (int i = 0; i < 3; ++i) launch(one_address, 1, 32, 0, sums.data());
    launch(one_address_a_lane, 2, 32, 0, sums.data());
    check(cudaDeviceSynchronize());
    const auto counts = cuda_on_cpu::stop_counting();
    launch(one_address, 1, 32, 0, sums.data());
    check(cudaDeviceSynchronize());
    ASSERT_EQ(counts.size(), 2u);
    EXPECT_EQ(counts[0].launches, 3u);
    EXPECT_EQ(counts[0].global.lanes, 96u);
    EXPECT_EQ(counts[0].most_at_one, 32u) << "of one launch";
    EXPECT_EQ(counts[1].launches, 1u);
    EXPECT_EQ(counts[1].warps, 2u);
}

TEST_F(MachineCounts, profiled_range_prints_a_table_with_names_of_kernels) {
    const Array<unsigned> sums(std::vector<unsigned>(32));
    settings().counts = true;
    testing::internal::CaptureStderr();
    launch(votes, 1, 32, 0, sums.data(), 1u);
    cudaProfilerStart();
    launch(one_address, 3, 64, 0, sums.data());
    cudaProfilerStop();
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_NE(text.find("\none_address "), std::string::npos) << text;
    EXPECT_NE(text.find(" 192 "), std::string::npos) << text;
    EXPECT_EQ(text.find("votes"), std::string::npos) << "launched before: " << text;
    settings().counts = false;
    testing::internal::CaptureStderr();
    cudaProfilerStart();
    launch(one_address, 3, 64, 0, sums.data());
    cudaProfilerStop();
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
