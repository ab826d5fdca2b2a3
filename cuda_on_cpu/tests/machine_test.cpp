// Settings of the machine: no device, little memory, failing calls, orders.

#include <unistd.h>

#include <cfenv>
#include <cstdlib>

#include "cuda_on_cpu/machine/memory.h"
#include "cuda_on_cpu/machine/settings.h"
#include "cuda_on_cpu/tests/fixture.h"
#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using cuda_on_cpu::Order;
using cuda_on_cpu::Progress;
using cuda_on_cpu::settings;
using portable::Array;
using portable::check;
using portable::launch;

class Machine : public cuda_on_cpu::FreshSettings {};

TEST_F(Machine, machine_can_have_no_device) {
    settings().devices = 0;
    int count = -1;
    EXPECT_EQ(cudaGetDeviceCount(&count), cudaErrorNoDevice);
    EXPECT_EQ(count, 0);
    void* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, 4), cudaErrorNoDevice);
    cudaStream_t stream = nullptr;
    EXPECT_EQ(cudaStreamCreate(&stream), cudaErrorNoDevice);
    EXPECT_EQ(cudaGetLastError(), cudaErrorNoDevice);
}

TEST_F(Machine, machine_can_have_no_driver) {
    settings().driver = false;
    int count = -1;
    EXPECT_EQ(cudaGetDeviceCount(&count), cudaErrorInsufficientDriver);
    EXPECT_EQ(count, -1) << "stays unwritten";
    EXPECT_EQ(cudaSetDevice(0), cudaErrorInsufficientDriver);
    EXPECT_EQ(cudaGetLastError(), cudaErrorInsufficientDriver);
    EXPECT_EQ(cudaGetLastError(), cudaErrorInsufficientDriver) << "again";
}

TEST_F(Machine, machine_can_have_several_devices) {
    settings().devices = 2;
    int count = 0;
    check(cudaGetDeviceCount(&count));
    EXPECT_EQ(count, 2);
    check(cudaSetDevice(1));
    const Array<int> memory(4);
    cudaPointerAttributes attributes;
    check(cudaPointerGetAttributes(&attributes, memory.data()));
    EXPECT_EQ(attributes.device, 1);
    check(cudaSetDevice(0));
}

TEST_F(Machine, machine_can_have_little_memory) {
    settings().device_bytes = cuda_on_cpu::memory::used() + 1000;
    const Array<char> most(900);
    void* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, 101), cudaErrorMemoryAllocation);
    EXPECT_EQ(memory, nullptr);
    check(cudaMalloc(&memory, 100));
    std::size_t free = 1, total = 0;
    check(cudaMemGetInfo(&free, &total));
    EXPECT_EQ(free, 0u);
    check(cudaFree(memory));
}

TEST_F(Machine, chosen_allocation_fails_and_later_ones_succeed) {
    const std::size_t before = cuda_on_cpu::memory::live();
    settings().allocations_before_failure = 1;
    void *first = nullptr, *second = nullptr;
    check(cudaMalloc(&first, 4));
    EXPECT_EQ(cudaMallocHost(&second, 4), cudaErrorMemoryAllocation);
    check(cudaMallocHost(&second, 4));
    EXPECT_EQ(cuda_on_cpu::memory::live(), before + 2);
    check(cudaFree(first));
    check(cudaFreeHost(second));
    EXPECT_EQ(cuda_on_cpu::memory::live(), before);
}

__global__ void nothing() {}

TEST_F(Machine, chosen_launch_fails_and_later_ones_succeed) {
    settings().launches_before_failure = 1;
    launch(nothing, 1, 1, 0);
    EXPECT_EQ(portable::try_launch(nullptr, nothing, 1, 1, 0), cudaErrorMemoryAllocation);
    EXPECT_EQ(cudaGetLastError(), cudaErrorMemoryAllocation);
    launch(nothing, 1, 1, 0);
    check(cudaDeviceSynchronize());
}

TEST_F(Machine, permanent_error_persists_over_several_calls) {
    settings().broken = cudaErrorIllegalAddress;
    void* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, 4), cudaErrorIllegalAddress);
    EXPECT_EQ(cudaGetLastError(), cudaErrorIllegalAddress);
    EXPECT_EQ(cudaGetLastError(), cudaErrorIllegalAddress) << "again";
    EXPECT_EQ(cudaDeviceSynchronize(), cudaErrorIllegalAddress);
    settings() = {};
    cudaGetLastError();
    check(cudaDeviceSynchronize());
}

__global__ void order_of_threads(int* place, int* next) { place[threadIdx.x] = atomicAdd(next, 1); }
__global__ void order_of_blocks(int* place, int* next) { place[blockIdx.x] = atomicAdd(next, 1); }

std::vector<int> order(void (*kernel)(int*, int*), unsigned blocks, unsigned threads) {
    const Array<int> place(64), next(std::vector<int>{0});
    launch(kernel, blocks, threads, 0, place.data(), next.data());
    return place.values();
}

TEST_F(Machine, order_of_threads_and_blocks_can_be_set) {
    settings().workers = 1;
    std::vector<int> up(64), down(64);
    for (int i = 0; i < 64; ++i) {
        up[static_cast<std::size_t>(i)] = i;
        down[static_cast<std::size_t>(i)] = 63 - i;
    }
    EXPECT_EQ(order(order_of_threads, 1, 64), up);
    EXPECT_EQ(order(order_of_blocks, 64, 1), up);
    settings().order = Order::reverse;
    EXPECT_EQ(order(order_of_threads, 1, 64), down);
    EXPECT_EQ(order(order_of_blocks, 64, 1), down);
    settings().order = Order::random;
    for (const auto kernel : {order_of_threads, order_of_blocks}) {
        const bool threads = kernel == order_of_threads;
        const auto again = [&] { return order(kernel, threads ? 1 : 64, threads ? 64 : 1); };
        settings().seed = 3;
        again();
        settings().seed = 2;
        const std::vector<int> one = again();
        EXPECT_NE(one, up);
        EXPECT_NE(one, down);
        settings().seed = 3;
        EXPECT_NE(again(), one);
        settings().seed = 2;
        EXPECT_EQ(again(), one) << "the same seed, the same order";
    }
}

TEST_F(Machine, streams_are_lazy_or_eager) {
    const auto done_before_waiting = [] {
        int* pinned = nullptr;
        check(cudaMallocHost(&pinned, 4));
        *pinned = 0;
        check(cudaLaunchHostFunc(
            nullptr, [](void* p) { *static_cast<int*>(p) = 1; }, pinned));
        const int result = *pinned;
        check(cudaDeviceSynchronize());
        EXPECT_EQ(*pinned, 1);
        check(cudaFreeHost(pinned));
        return result;
    };
    EXPECT_EQ(done_before_waiting(), 0);
    settings().progress = Progress::eager;
    EXPECT_EQ(done_before_waiting(), 1);
    settings().progress = Progress::random;
    int done = 0;
    for (int i = 0; i < 60; ++i) done += done_before_waiting();
    EXPECT_GT(done, 0);
    EXPECT_LT(done, 60);
}

__global__ void third(float* out, float one) { *out = one / 3.0f; }

TEST_F(Machine, kernels_round_to_nearest_in_any_mode_of_the_host) {
    const Array<float> out(1);
    const int before = std::fegetround();
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO})
        for (const bool negative : {false, true}) {
            std::fesetround(mode);
            launch(third, 1, 1, 0, out.data(), negative ? -1.0f : 1.0f);
            check(cudaDeviceSynchronize());
            std::fesetround(before);
            constexpr float nearest = 1.0f / 3.0f;
            EXPECT_EQ(out.values()[0], negative ? -nearest : nearest) << "mode " << mode;
        }
}

TEST_F(Machine, registers_limit_the_blocks_of_a_multiprocessor) {
    const auto blocks_with = [](int registers) {
        settings().registers = registers;
        int blocks = 0;
        check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, third, 256, 0));
        return blocks;
    };
    EXPECT_EQ(blocks_with(32), 8);
    EXPECT_EQ(blocks_with(64), 4);
    EXPECT_EQ(blocks_with(80), 3);
}

TEST_F(Machine, invalid_setting_is_an_error) {
    const auto run_with = [](const char* variable, const char* value) {
        setenv(variable, value, 1);
        execl("/proc/self/exe", "cuda_on_cpu_test", "--gtest_filter=Barrier.*", nullptr);
    };
    EXPECT_DEATH(run_with("CUDA_ON_CPU_ORDER", "sideways"), "CUDA_ON_CPU_ORDER=sideways is not supported");
    EXPECT_DEATH(run_with("CUDA_ON_CPU_COUNTS", "yes"), "CUDA_ON_CPU_COUNTS=yes is not supported");
    EXPECT_DEATH(run_with("CUDA_ON_CPU_MULTIPROCESSORS", "0"), "CUDA_ON_CPU_MULTIPROCESSORS must be at least 1");
    EXPECT_DEATH(run_with("CUDA_ON_CPU_REGISTERS", "256"), "CUDA_ON_CPU_REGISTERS must be from 1 to 255");
}

TEST_F(Machine, barriers_and_warp_functions_outside_of_a_launch_abort) {
    const char* const message = "device code runs on the host, outside of a launch";
    EXPECT_DEATH(__syncthreads(), message);
    EXPECT_DEATH(__syncthreads_or(1), message);
    EXPECT_DEATH(__syncwarp(), message);
    EXPECT_DEATH(__ballot_sync(0xffffffffu, 1), message);
    EXPECT_DEATH(__shfl_sync(0xffffffffu, 1, 0), message);
}

}  // namespace
