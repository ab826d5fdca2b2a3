// Functions that the lanes of a warp call together: votes, shuffles, matches, reductions, barriers.

#include <algorithm>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::launch;

class Warp : public portable::DeviceTest {};

constexpr unsigned full = 0xffffffffu;

/// Returns the lanes of the caller's warp that exist.
__device__ unsigned present() {
    const unsigned left = blockDim.x - threadIdx.x / 32 * 32;
    return left >= 32 ? full : (1u << left) - 1;
}

__global__ void vote(unsigned* out) {
    const unsigned i = threadIdx.x, mask = present();
    out[i] = __ballot_sync(mask, i % 5 == 0);
    out[blockDim.x + i] = static_cast<unsigned>(__any_sync(mask, i == 70) != 0) * 2 + (__all_sync(mask, i < 64) != 0);
}

TEST_F(Warp, votes_are_right_in_whole_and_partial_warps) {
    const unsigned n = 80;  // the third warp has 16 lanes
    const Array<unsigned> out(2 * n);
    launch(vote, 1, n, 0, out.data());
    std::vector<unsigned> expected(2 * n);
    for (unsigned i = 0; i < n; ++i) {
        for (unsigned j = i / 32 * 32; j < std::min(n, i / 32 * 32 + 32); ++j)
            if (j % 5 == 0) expected[i] |= 1u << j % 32;
        expected[n + i] = (i >= 64) * 2u + (i < 64);
    }
    EXPECT_EQ(out.values(), expected);
}

template <class T>
__global__ void exchange(T* out, int width) {
    const int i = static_cast<int>(threadIdx.x);
    const T mine = static_cast<T>(i * 10);
    T* const o = out + i * 5;
    o[0] = __shfl_sync(full, mine, 3, width);
    o[1] = __shfl_up_sync(full, mine, 2, width);
    o[2] = __shfl_down_sync(full, mine, 2, width);
    o[3] = __shfl_xor_sync(full, mine, 1, width);
    o[4] = __shfl_sync(full, mine, i + 1, width);
}

template <class T>
void expect_exchange(int width) {
    const int n = 64;
    const Array<T> out(5 * n);
    launch(exchange<T>, 1, n, 0, out.data(), width);
    std::vector<T> expected;
    for (int i = 0; i < n; ++i) {
        const int first = i / width * width, r = i - first;
        const int sources[] = {first + 3 % width, r >= 2 ? i - 2 : i, r + 2 < width ? i + 2 : i, width > 1 ? i ^ 1 : i,
                               first + (i + 1) % width};
        for (const int source : sources) expected.push_back(static_cast<T>(source * 10));
    }
    EXPECT_EQ(out.values(), expected) << "width " << width;
}

TEST_F(Warp, shuffles_stay_in_segments) {
    for (const int width : {32, 16, 8, 4, 2}) {
        expect_exchange<int>(width);
        expect_exchange<float>(width);
        expect_exchange<unsigned long long>(width);
        expect_exchange<double>(width);
    }
}

// Lets each half of a warp loop a different number of times.
__global__ void halves(const int* rounds, unsigned* out) {
    const unsigned lane = threadIdx.x % 32, half = threadIdx.x / 16;
    const unsigned mask = lane < 16 ? 0x0000ffffu : 0xffff0000u;
    unsigned sum = 0;
    for (int r = 0; r < rounds[half]; ++r) {
        const unsigned from = (lane + static_cast<unsigned>(r)) % 16;
        sum += __shfl_sync(mask, threadIdx.x, static_cast<int>(from), 16);
        if (__any_sync(mask, r == 100)) sum += 1000000;
    }
    __syncwarp();
    out[threadIdx.x] = sum;
}

TEST_F(Warp, lanes_of_disjoint_masks_run_independently) {
    const std::vector<int> rounds = {1, 7, 16, 0};
    const Array<int> in(rounds);
    const Array<unsigned> out(64);
    launch(halves, 1, 64, 0, in.data(), out.data());
    std::vector<unsigned> expected(64);
    for (unsigned i = 0; i < 64; ++i)
        for (unsigned r = 0; r < static_cast<unsigned>(rounds[i / 16]); ++r) expected[i] += i / 16 * 16 + (i + r) % 16;
    EXPECT_EQ(out.values(), expected);
}

// Lets lanes leave a loop one by one. The masks of the remaining lanes name only remaining lanes.
__global__ void leave_one_by_one(unsigned* out) {
    const unsigned lane = threadIdx.x;
    unsigned seen = 0, mask = full;
    for (unsigned round = 0; round <= lane; ++round) {
        seen += static_cast<unsigned>(__popc(__ballot_sync(mask, 1)));
        mask = __ballot_sync(mask, lane > round);
    }
    out[lane] = seen;
}

TEST_F(Warp, masks_may_shrink_as_lanes_leave) {
    const Array<unsigned> out(32);
    launch(leave_one_by_one, 1, 32, 0, out.data());
    std::vector<unsigned> expected;
    unsigned sum = 0;
    for (unsigned lane = 0; lane < 32; ++lane) expected.push_back(sum += 32 - lane);
    EXPECT_EQ(out.values(), expected);
}

__global__ void match(unsigned* out) {
    const unsigned lane = threadIdx.x;
    int same = -1, different = -1;
    out[lane] = __match_any_sync(full, lane % 3);
    out[32 + lane] = __match_all_sync(full, 4.5f, &same);
    out[64 + lane] = __match_all_sync(full, static_cast<unsigned long long>(lane / 31), &different);
    out[96 + lane] = static_cast<unsigned>((same != 0) * 2 + (different != 0));
}

TEST_F(Warp, matches_name_lanes_with_equal_values) {
    const Array<unsigned> out(128);
    launch(match, 1, 32, 0, out.data());
    std::vector<unsigned> expected(128);
    for (unsigned i = 0; i < 32; ++i) {
        for (unsigned j = i % 3; j < 32; j += 3) expected[i] |= 1u << j;
        expected[32 + i] = full;
        expected[96 + i] = 2;
    }
    EXPECT_EQ(out.values(), expected);
}

__global__ void reduce(int* out) {
    const int lane = static_cast<int>(threadIdx.x);
    const unsigned odd = 0xaaaaaaaau, mask = lane % 2 ? odd : ~odd;
    const unsigned u = static_cast<unsigned>(lane);
    int* const o = out + lane * 7;
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 800
    o[0] = __reduce_add_sync(mask, lane - 10);
    o[1] = __reduce_min_sync(mask, lane - 10);
    o[2] = __reduce_max_sync(mask, lane - 10);
    o[3] = static_cast<int>(__reduce_and_sync(mask, u | 0x40));
    o[4] = static_cast<int>(__reduce_or_sync(mask, u));
    o[5] = static_cast<int>(__reduce_xor_sync(mask, u + 1));
    o[6] = static_cast<int>(__reduce_max_sync(mask, u - 1));
#endif
}

TEST_F(Warp, reductions_cover_the_lanes_of_the_mask) {
    int major = 0;
    ASSERT_EQ(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, 0), cudaSuccess);
    if (major < 8) GTEST_SKIP() << "the device has none";
    const Array<int> out(32 * 7);
    launch(reduce, 1, 32, 0, out.data());
    std::vector<int> expected;
    for (int i = 0; i < 32; ++i) {
        const bool odd = i % 2 != 0;
        const int one = odd ? 96 : 80;
        expected.insert(expected.end(), {one, odd ? -9 : -10, odd ? 21 : 20, odd ? 0x41 : 0x40, odd ? 31 : 30,
                                         odd ? 32 : 0, odd ? 30 : -1});
    }
    EXPECT_EQ(out.values(), expected);
}

struct Exchange {
    int items[64];
};

__global__ void through_shared(int* out) {
    Exchange& s = portable::dynamic_shared<Exchange>();
    const unsigned i = threadIdx.x;
    for (int round = 0; round < 4; ++round) {
        s.items[i] = static_cast<int>(i) + round;
        __syncwarp();
        out[i] = s.items[i ^ 1];
        __syncwarp();
    }
}

TEST_F(Warp, a_warp_barrier_orders_shared_memory) {
    const Array<int> out(64);
    launch(through_shared, 1, 64, sizeof(Exchange), out.data());
    std::vector<int> expected;
    for (int i = 0; i < 64; ++i) expected.push_back((i ^ 1) + 3);
    EXPECT_EQ(out.values(), expected);
}

}  // namespace
