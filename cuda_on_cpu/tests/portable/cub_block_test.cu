// CUB's block and warp primitives, and the speed of threads.

#include <algorithm>
#include <cstdint>
#include <cub/block/block_radix_sort.cuh>
#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>
#include <cub/warp/warp_reduce.cuh>
#include <cub/warp/warp_scan.cuh>
#include <limits>
#include <numeric>
#include <random>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::launch;

struct Smaller {
    __device__ int operator()(int a, int b) const { return b < a ? b : a; }
};

template <int Threads>
struct BlockPrimitives {
    static constexpr int items = 3;
    using Scan = cub::BlockScan<int, Threads>;
    using Reduce = cub::BlockReduce<int, Threads>;
    using Sort = cub::BlockRadixSort<float, Threads, items, std::uint16_t>;
    using SortKeys = cub::BlockRadixSort<unsigned, Threads, items>;
    struct Shared {
        union {
            typename Scan::TempStorage scan;
            typename Reduce::TempStorage reduce;
            typename Sort::TempStorage sort;
            typename SortKeys::TempStorage sort_keys;
        } storage;
        int total;
    };
};

template <int Threads>
__global__ void scans(const int* in, int* out) {
    using P = BlockPrimitives<Threads>;
    using Scan = typename P::Scan;
    auto& s = portable::dynamic_shared<typename P::Shared>();
    const int t = static_cast<int>(threadIdx.x);
    int* const o = out + t * 12;
    int items[P::items], results[P::items], total;
    for (int i = 0; i < P::items; ++i) items[i] = in[t * P::items + i];

    Scan(s.storage.scan).ExclusiveSum(items[0], o[0], total);
    o[1] = total;
    __syncthreads();
    Scan(s.storage.scan).InclusiveSum(items[0], o[2]);
    __syncthreads();
    Scan(s.storage.scan).ExclusiveSum(items, results, total);
    o[3] = total;
    for (int i = 0; i < P::items; ++i) o[4 + i] = results[i];
    __syncthreads();
    Scan(s.storage.scan).InclusiveScan(items, results, Smaller());
    for (int i = 0; i < P::items; ++i) o[7 + i] = results[i];
    __syncthreads();
    Scan(s.storage.scan).ExclusiveScan(items[0], o[10], 1000, Smaller(), total);
    o[11] = total;
}

template <int Threads>
__global__ void reductions(const int* in, int* out, int valid) {
    using P = BlockPrimitives<Threads>;
    using Reduce = typename P::Reduce;
    auto& s = portable::dynamic_shared<typename P::Shared>();
    const int mine = in[threadIdx.x];
    const int sum = Reduce(s.storage.reduce).Sum(mine);
    __syncthreads();
    const int least = Reduce(s.storage.reduce).Reduce(mine, Smaller());
    __syncthreads();
    const int part = Reduce(s.storage.reduce).Sum(mine, valid);
    if (threadIdx.x == 0) {
        out[0] = sum;
        out[1] = least;
        out[2] = part;
    }
}

template <int Threads>
__global__ void sorts(const float* in, float* out, std::uint16_t* from, const unsigned* keys_in, unsigned* keys_out) {
    using P = BlockPrimitives<Threads>;
    auto& s = portable::dynamic_shared<typename P::Shared>();
    const int t = static_cast<int>(threadIdx.x);
    float keys[P::items];
    std::uint16_t values[P::items];
    unsigned numbers[P::items];
    for (int i = 0; i < P::items; ++i) {
        keys[i] = in[t * P::items + i];
        values[i] = static_cast<std::uint16_t>(t * P::items + i);
        numbers[i] = keys_in[t * P::items + i];
    }
    typename P::Sort(s.storage.sort).Sort(keys, values);
    __syncthreads();
    typename P::SortKeys(s.storage.sort_keys).SortBlockedToStriped(numbers, 4, 12);
    for (int i = 0; i < P::items; ++i) {
        out[t * P::items + i] = keys[i];
        from[t * P::items + i] = values[i];
        keys_out[i * Threads + t] = numbers[i];
    }
}

template <class Size>
class BlockPrimitive : public portable::DeviceTest {};
using Sizes = testing::Types<std::integral_constant<int, 64>, std::integral_constant<int, 256>>;
TYPED_TEST_SUITE(BlockPrimitive, Sizes);

std::vector<int> some_integers(std::size_t n) {
    std::mt19937 random(5);
    std::vector<int> result(n);
    for (int& x : result) x = static_cast<int>(random() % 2001) - 1000;
    return result;
}

TYPED_TEST(BlockPrimitive, scans_match_sequential_ones) {
    constexpr int n = TypeParam::value, items = BlockPrimitives<n>::items;
    const std::vector<int> values = some_integers(n * items);
    const int* const in = values.data();
    const Array<int> from(values), out(n * 12);
    launch(scans<n>, 1, n, sizeof(typename BlockPrimitives<n>::Shared), from.data(), out.data());
    std::vector<int> expected;
    int firsts = 0, all = 0, least = in[0], least_first = 1000;
    const int total = std::accumulate(values.begin(), values.end(), 0);
    int total_firsts = 0, smallest_first = std::numeric_limits<int>::max();
    for (int t = 0; t < n; ++t) {
        total_firsts += in[t * items];
        smallest_first = std::min(smallest_first, in[t * items]);
    }
    for (int t = 0; t < n; ++t) {
        const int first = in[t * items];
        expected.insert(expected.end(), {firsts, total_firsts, firsts + first, total});
        firsts += first;
        for (int i = 0; i < items; ++i) {
            expected.push_back(all);
            all += in[t * items + i];
        }
        for (int i = 0; i < items; ++i) expected.push_back(least = std::min(least, in[t * items + i]));
        expected.insert(expected.end(), {least_first, smallest_first});
        least_first = std::min(least_first, first);
    }
    EXPECT_EQ(out.values(), expected);
}

TYPED_TEST(BlockPrimitive, reductions_match_sequential_ones) {
    constexpr int n = TypeParam::value;
    const std::vector<int> in = some_integers(n);
    const Array<int> from(in), out(3);
    launch(reductions<n>, 1, n, sizeof(typename BlockPrimitives<n>::Shared), from.data(), out.data(), 40);
    EXPECT_EQ(out.values(),
              (std::vector<int>{std::accumulate(in.begin(), in.end(), 0), *std::min_element(in.begin(), in.end()),
                                std::accumulate(in.begin(), in.begin() + 40, 0)}));
}

TYPED_TEST(BlockPrimitive, radix_sorts_are_stable) {
    constexpr int n = TypeParam::value, items = BlockPrimitives<n>::items;
    std::vector<float> keys;
    std::vector<unsigned> numbers;
    for (const int x : some_integers(n * items)) {
        keys.push_back(static_cast<float>(x / 50) * 0.5f);  // many equal, and both zeros
        numbers.push_back(static_cast<unsigned>(x) * 2654435761u);
    }
    keys[3] = -0.0f;
    keys[8] = std::numeric_limits<float>::infinity();
    keys[9] = -std::numeric_limits<float>::infinity();
    const Array<float> in(keys), out(keys.size());
    const Array<std::uint16_t> from(keys.size());
    const Array<unsigned> keys_in(numbers), keys_out(numbers.size());
    launch(sorts<n>, 1, n, sizeof(typename BlockPrimitives<n>::Shared), in.data(), out.data(), from.data(),
           keys_in.data(), keys_out.data());
    std::vector<std::uint16_t> order(keys.size());
    std::iota(order.begin(), order.end(), std::uint16_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    EXPECT_EQ(from.values(), order);
    const std::vector<float> found = out.values();
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], keys[order[i]]) << i;
    std::stable_sort(numbers.begin(), numbers.end(),
                     [](unsigned a, unsigned b) { return (a >> 4 & 0xff) < (b >> 4 & 0xff); });
    EXPECT_EQ(keys_out.values(), numbers);
}

class WarpPrimitive : public portable::DeviceTest {};

struct WarpStorage {
    cub::WarpScan<int>::TempStorage scan[2];
    cub::WarpReduce<int>::TempStorage reduce[2];
    cub::WarpScan<int, 8>::TempStorage scan_of_8[8];
};

__global__ void warp_primitives(const int* in, int* out) {
    auto& s = portable::dynamic_shared<WarpStorage>();
    const int t = static_cast<int>(threadIdx.x), warp = t / 32;
    int* const o = out + t * 5;
    int sum, total, eight, least;
    cub::WarpScan<int>(s.scan[warp]).ExclusiveSum(in[t], sum, total);
    __syncwarp();
    cub::WarpScan<int>(s.scan[warp]).InclusiveScan(in[t], least, Smaller());
    cub::WarpScan<int, 8>(s.scan_of_8[t / 8]).InclusiveSum(in[t], eight);
    const int reduced = cub::WarpReduce<int>(s.reduce[warp]).Sum(in[t]);
    o[0] = sum;
    o[1] = total;
    o[2] = least;
    o[3] = eight;
    o[4] = t % 32 == 0 ? reduced : 0;
}

TEST_F(WarpPrimitive, scans_and_reductions_match_sequential_ones) {
    const std::vector<int> in = some_integers(64);
    const Array<int> from(in), out(64 * 5);
    launch(warp_primitives, 1, 64, sizeof(WarpStorage), from.data(), out.data());
    std::vector<int> expected;
    for (int t = 0; t < 64; ++t) {
        const auto warp = in.begin() + t / 32 * 32, eight = in.begin() + t / 8 * 8, here = in.begin() + t;
        const int total = std::accumulate(warp, warp + 32, 0);
        expected.insert(expected.end(), {std::accumulate(warp, here, 0), total, *std::min_element(warp, here + 1),
                                         std::accumulate(eight, here + 1, 0), t % 32 == 0 ? total : 0});
    }
    EXPECT_EQ(out.values(), expected);
}

class Speed : public portable::DeviceTest {};

template <int Threads>
__global__ void compact(const int* in, int n, int* out, int* count) {
    using P = BlockPrimitives<Threads>;
    auto& s = portable::dynamic_shared<typename P::Shared>();
    const int i = static_cast<int>(blockIdx.x * Threads + threadIdx.x);
    const int keep = i < n && in[i] > 0;
    int place, total;
    typename P::Scan(s.storage.scan).ExclusiveSum(keep, place, total);
    if (threadIdx.x == 0) s.total = atomicAdd(count, total);
    __syncthreads();
    if (keep) out[s.total + place] = in[i];
}

// Has as many threads as the scenes of the agreement tests need. ctest reports the time.
TEST_F(Speed, ninety_two_thousand_threads_compact_an_array) {
    const int n = 92230;
    std::vector<int> in = some_integers(n);
    const Array<int> from(in), out(in.size()), count(std::vector<int>{0});
    launch(compact<256>, (n + 255) / 256, 256, sizeof(BlockPrimitives<256>::Shared), from.data(), n, out.data(),
           count.data());
    std::vector<int> expected, found = out.values();
    std::copy_if(in.begin(), in.end(), std::back_inserter(expected), [](int x) { return x > 0; });
    ASSERT_EQ(static_cast<std::size_t>(count.values()[0]), expected.size());
    found.resize(expected.size());
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(found, expected);
}

}  // namespace
