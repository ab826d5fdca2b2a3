// Indices, barriers and shared memory.

#include <algorithm>
#include <numeric>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::launch;

class Barrier : public portable::DeviceTest {};

constexpr int most_threads = 1024;

struct Reversal {
    int items[most_threads];
};

__global__ void reverse(const int* in, int* out) {
    Reversal& s = portable::dynamic_shared<Reversal>();
    const unsigned n = blockDim.x, i = threadIdx.x, base = blockIdx.x * n;
    s.items[i] = in[base + i];
    __syncthreads();
    out[base + i] = s.items[n - 1 - i];
}

TEST_F(Barrier, barrier_orders_shared_memory) {
    for (const int threads : {1, 31, 32, 33, 64, 80, 256, 1024}) {
        std::vector<int> in(static_cast<std::size_t>(threads) * 5);
        std::iota(in.begin(), in.end(), 100);
        const Array<int> from(in), to(in.size());
        launch(reverse, 5, static_cast<unsigned>(threads), sizeof(Reversal), from.data(), to.data());
        std::vector<int> expected = in;
        for (int b = 0; b < 5; ++b) std::reverse(expected.begin() + b * threads, expected.begin() + (b + 1) * threads);
        EXPECT_EQ(to.values(), expected) << threads << " threads";
    }
}

// Sums by a tree whose steps read the results of the previous step, repeatedly in the same memory.
__global__ void sum_by_halves(const int* in, int* out, int rounds) {
    Reversal& s = portable::dynamic_shared<Reversal>();
    const unsigned i = threadIdx.x;
    int total = 0;
    for (int round = 0; round < rounds; ++round) {
        s.items[i] = in[i] + round;
        __syncthreads();
        for (unsigned half = blockDim.x / 2; half > 0; half /= 2) {
            if (i < half) s.items[i] += s.items[i + half];
            __syncthreads();
        }
        total += s.items[0];
        __syncthreads();
    }
    out[i] = total;
}

TEST_F(Barrier, barrier_separates_the_rounds_of_a_loop) {
    for (const int threads : {64, 256}) {
        const Array<int> in(std::vector<int>(static_cast<std::size_t>(threads), 2)),
            out(static_cast<std::size_t>(threads));
        launch(sum_by_halves, 1, static_cast<unsigned>(threads), sizeof(Reversal), in.data(), out.data(), 10);
        EXPECT_EQ(out.values(), std::vector<int>(static_cast<std::size_t>(threads), threads * (20 + 45)));
    }
}

__global__ void votes(int* out) {
    const int i = static_cast<int>(threadIdx.x);
    const int count = __syncthreads_count(i % 3 == 0);
    const int any = __syncthreads_or(i == 7), none = __syncthreads_or(i < 0);
    const int all = __syncthreads_and(i >= 0), not_all = __syncthreads_and(i != 7);
    out[i] = count * 16 + (any != 0) * 8 + (none != 0) * 4 + (all != 0) * 2 + (not_all != 0);
}

TEST_F(Barrier, barriers_report_count_any_and_all_of_a_predicate) {
    const Array<int> out(70);
    launch(votes, 1, 70, 0, out.data());
    EXPECT_EQ(out.values(), std::vector<int>(70, 24 * 16 + 8 + 2));
}

__global__ void ranks(int* out) {
    const unsigned thread = (threadIdx.z * blockDim.y + threadIdx.y) * blockDim.x + threadIdx.x;
    const unsigned block = (blockIdx.z * gridDim.y + blockIdx.y) * gridDim.x + blockIdx.x;
    const unsigned threads = blockDim.x * blockDim.y * blockDim.z;
    out[block * threads + thread] +=
        static_cast<int>(threadIdx.x + 10 * threadIdx.y + 100 * threadIdx.z + 1000 * blockIdx.z);
}

TEST_F(Barrier, every_thread_of_a_grid_in_three_dimensions_runs_once) {
    const std::size_t n = 2 * 3 * 4 * 5 * 6 * 7;
    const Array<int> out(std::vector<int>(n, 5));
    launch(ranks, dim3(2, 3, 4), dim3(5, 6, 7), 0, out.data());
    std::vector<int> expected;
    for (int block = 0; block < 24; ++block)
        for (int z = 0; z < 7; ++z)
            for (int y = 0; y < 6; ++y)
                for (int x = 0; x < 5; ++x) expected.push_back(5 + x + 10 * y + 100 * z + 1000 * (block / 6));
    EXPECT_EQ(out.values(), expected);
}

struct Large {
    float first[4 << 10];
    float last[10 << 10];
};

__global__ void fill_large(float* out) {
    Large& s = portable::dynamic_shared<Large>();
    s.first[threadIdx.x] = static_cast<float>(threadIdx.x);
    s.last[(10 << 10) - 1 - threadIdx.x] = 1.0f;
    __syncthreads();
    out[threadIdx.x] = s.first[blockDim.x - 1 - threadIdx.x] + s.last[(10 << 10) - blockDim.x + threadIdx.x];
}

TEST_F(Barrier, more_than_48_KiB_of_shared_memory_needs_an_attribute) {
    const Array<float> out(64);
    EXPECT_EQ(portable::try_launch(nullptr, fill_large, 1, 64, sizeof(Large), out.data()), cudaErrorInvalidValue);
    EXPECT_EQ(cudaGetLastError(), cudaErrorInvalidValue);
    ASSERT_EQ(cudaFuncSetAttribute(fill_large, cudaFuncAttributeMaxDynamicSharedMemorySize, sizeof(Large)),
              cudaSuccess);
    launch(fill_large, 1, 64, sizeof(Large), out.data());
    EXPECT_EQ(out.values().front(), 64.0f);
    EXPECT_EQ(out.values().back(), 1.0f);
    EXPECT_NE(cudaFuncSetAttribute(fill_large, cudaFuncAttributeMaxDynamicSharedMemorySize, 300 << 10), cudaSuccess);
    EXPECT_NE(cudaGetLastError(), cudaSuccess);
}

TEST_F(Barrier, impossible_launches_are_refused) {
    const Array<int> out(1);
    EXPECT_EQ(portable::try_launch(nullptr, votes, 1, 1025, 0, out.data()), cudaErrorInvalidValue);
    EXPECT_EQ(portable::try_launch(nullptr, votes, 0, 32, 0, out.data()), cudaErrorInvalidValue);
    EXPECT_EQ(portable::try_launch(nullptr, votes, dim3(1, 65536), 32, 0, out.data()), cudaErrorInvalidValue);
    EXPECT_EQ(cudaGetLastError(), cudaErrorInvalidValue);
}

}  // namespace
