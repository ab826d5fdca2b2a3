// Atomic functions and fences.

#include <algorithm>
#include <climits>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::launch;

class Atomics : public portable::DeviceTest {};

struct Counter {
    int count;
};

__global__ void count(unsigned long long* total, int* blocks, float* sum, double* precise) {
    Counter& s = portable::dynamic_shared<Counter>();
    if (threadIdx.x == 0) s.count = 0;
    __syncthreads();
    atomicAdd(&s.count, 1);
    atomicAdd(sum, 0.5f);
    atomicAdd(precise, 0.25);
    __syncthreads();
    if (threadIdx.x == 0) {
        atomicAdd(total, static_cast<unsigned long long>(s.count) << 32);
        atomicAdd(blocks, 1);
    }
}

TEST_F(Atomics, atomics_add_up_over_many_blocks) {
    const Array<unsigned long long> total(std::vector<unsigned long long>{7});
    const Array<int> blocks(std::vector<int>{0});
    const Array<float> sum(std::vector<float>{0});
    const Array<double> precise(std::vector<double>{1});
    launch(count, 40, 96, sizeof(Counter), total.data(), blocks.data(), sum.data(), precise.data());
    EXPECT_EQ(total.values()[0], (40ull * 96 << 32) + 7);
    EXPECT_EQ(blocks.values()[0], 40);
    EXPECT_EQ(sum.values()[0], 1920.0f);
    EXPECT_EQ(precise.values()[0], 961.0);
}

__global__ void all_kinds(int* i, unsigned* u, unsigned long long* l, unsigned* returned) {
    const int t = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    const unsigned bit = 1u << t % 32;
    atomicMin(&i[0], -t);
    atomicMax(&i[1], t);
    atomicSub(&i[2], 2);
    atomicOr(&u[0], bit);
    atomicAnd(&u[1], ~(bit & 0xff00u));
    if (t < 5 * 32) atomicXor(&u[2], bit);  // toggles each bit an odd number of times
    atomicInc(&u[3], 9);
    atomicDec(&u[4], 9);
    atomicMin(&l[0], static_cast<unsigned long long>(t) + (1ull << 40));
    atomicMax(&l[1], static_cast<unsigned long long>(t) << 40);
    // A lock-free maximum by CAS.
    unsigned seen = atomicAdd(&u[5], 0u);
    while (seen < static_cast<unsigned>(t)) {
        const unsigned before = atomicCAS(&u[5], seen, static_cast<unsigned>(t));
        if (before == seen) break;
        seen = before;
    }
    returned[t] = atomicAdd(&u[6], 1u);
    if (t == 5) atomicExch(&u[7], 77u);
}

TEST_F(Atomics, operations_of_all_kinds_lose_no_update) {
    const int n = 3 * 64;
    const Array<int> i(std::vector<int>{INT_MAX, INT_MIN, 0});
    const Array<unsigned> u(std::vector<unsigned>{0, ~0u, 0, 0, 0, 0, 0, 0});
    const Array<unsigned long long> l(std::vector<unsigned long long>{~0ull, 0});
    const Array<unsigned> returned(n);
    launch(all_kinds, 3, 64, 0, i.data(), u.data(), l.data(), returned.data());
    EXPECT_EQ(i.values(), (std::vector<int>{-(n - 1), n - 1, -2 * n}));
    // atomicInc and atomicDec cycle through ten values, 0 to 9. 192 steps are two more than a multiple of ten: from 0
    // up to 2, and from 0 down to 8.
    EXPECT_EQ(u.values(), (std::vector<unsigned>{~0u, 0xffff00ffu, ~0u, 2, 8, n - 1, n, 77}));
    EXPECT_EQ(l.values(), (std::vector<unsigned long long>{1ull << 40, static_cast<unsigned long long>(n - 1) << 40}));
    std::vector<unsigned> order = returned.values();
    std::sort(order.begin(), order.end());
    for (unsigned k = 0; k < n; ++k) EXPECT_EQ(order[k], k);
}

// Lets the last block that arrives add up the parts of all blocks.
__global__ void last_block_sums(int* parts, unsigned* arrived, int* total) {
    if (threadIdx.x != 0) return;
    parts[blockIdx.x] = static_cast<int>(blockIdx.x) + 1;
    __threadfence();
    if (atomicAdd(arrived, 1u) != gridDim.x - 1) return;
    __threadfence();
    int sum = 0;
    for (unsigned b = 0; b < gridDim.x; ++b) sum += parts[b];
    *total = sum;
}

TEST_F(Atomics, last_block_sums_the_parts_of_all_blocks) {
    const Array<int> parts(100), total(1);
    const Array<unsigned> arrived(std::vector<unsigned>{0});
    launch(last_block_sums, 100, 32, 0, parts.data(), arrived.data(), total.data());
    EXPECT_EQ(total.values()[0], 5050);
}

// Orders blocks by tickets; each waits for the one before.
__global__ void chain(unsigned* ticket, unsigned* done, unsigned* order) {
    if (threadIdx.x != 0) return;
    const unsigned mine = atomicAdd(ticket, 1u);
    while (atomicAdd(done, 0u) != mine) __nanosleep(100);
    __threadfence();
    order[mine] = mine == 0 ? 1 : order[mine - 1] * 3 + 1;
    __threadfence();
    atomicAdd(done, 1u);
}

TEST_F(Atomics, blocks_may_wait_for_earlier_ones) {
    const Array<unsigned> ticket(std::vector<unsigned>{0}), done(std::vector<unsigned>{0}), order(12);
    launch(chain, 12, 2, 0, ticket.data(), done.data(), order.data());
    unsigned expected = 0;
    for (const unsigned found : order.values()) EXPECT_EQ(found, expected = expected * 3 + 1);
}

}  // namespace
