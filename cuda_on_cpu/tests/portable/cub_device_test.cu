// CUB's device-wide primitives.

#include <algorithm>
#include <cstdint>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_reduce.cuh>
#include <cub/device/device_run_length_encode.cuh>
#include <cub/device/device_scan.cuh>
#include <cub/device/device_segmented_radix_sort.cuh>
#include <cub/device/device_segmented_sort.cuh>
#include <cub/device/device_select.cuh>
#include <numeric>
#include <random>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::check;

class DevicePrimitive : public portable::DeviceTest {};

/// Calls a primitive for the size of its temporary storage, then with that storage.
template <class F>
void in_two_phases(F primitive) {
    std::size_t bytes = 0;
    check(primitive(static_cast<void*>(nullptr), bytes));
    ASSERT_GT(bytes, 0u);
    const Array<char> storage(bytes);
    check(primitive(static_cast<void*>(storage.data()), bytes));
}

std::vector<int> some_integers(std::size_t n, int range = 1000) {
    std::mt19937 random(9);
    std::vector<int> result(n);
    for (int& x : result) x = static_cast<int>(random() % static_cast<unsigned>(range));
    return result;
}

struct Positive {
    __host__ __device__ bool operator()(int x) const { return x >= 500; }
};
struct Larger {
    __host__ __device__ int operator()(int a, int b) const { return a < b ? b : a; }
};

TEST_F(DevicePrimitive, scans_match_sequential_ones) {
    const std::vector<int> in = some_integers(3000);
    const int n = static_cast<int>(in.size());
    const Array<int> from(in), exclusive(in.size()), inclusive(in.size()), largest(in.size()), in_place(in);
    in_two_phases(
        [&](void* s, std::size_t& b) { return cub::DeviceScan::ExclusiveSum(s, b, from.data(), exclusive.data(), n); });
    in_two_phases(
        [&](void* s, std::size_t& b) { return cub::DeviceScan::InclusiveSum(s, b, from.data(), inclusive.data(), n); });
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceScan::ExclusiveScan(s, b, from.data(), largest.data(), Larger(), 3, n);
    });
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceScan::ExclusiveSum(s, b, in_place.data(), in_place.data(), n);
    });
    std::vector<int> expected(in.size());
    std::partial_sum(in.begin(), in.end(), expected.begin());
    EXPECT_EQ(inclusive.values(), expected);
    std::exclusive_scan(in.begin(), in.end(), expected.begin(), 0);
    EXPECT_EQ(exclusive.values(), expected);
    EXPECT_EQ(in_place.values(), expected);
    std::exclusive_scan(in.begin(), in.end(), expected.begin(), 3, Larger());
    EXPECT_EQ(largest.values(), expected);
}

TEST_F(DevicePrimitive, too_little_storage_is_refused) {
    const Array<int> data(30000);
    std::size_t bytes = 0;
    check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, data.data(), data.data(), 30000));
    const Array<char> storage(bytes);
    --bytes;
    EXPECT_EQ(cub::DeviceScan::ExclusiveSum(storage.data(), bytes, data.data(), data.data(), 30000),
              cudaErrorInvalidValue);
    cudaGetLastError();
}

TEST_F(DevicePrimitive, reductions_match_sequential_ones) {
    const std::vector<int> in = some_integers(3000);
    const int n = static_cast<int>(in.size());
    const Array<int> from(in), least(1), largest(1);
    const Array<long long> sum(1);
    in_two_phases([&](void* s, std::size_t& b) { return cub::DeviceReduce::Sum(s, b, from.data(), sum.data(), n); });
    in_two_phases([&](void* s, std::size_t& b) { return cub::DeviceReduce::Min(s, b, from.data(), least.data(), n); });
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceReduce::Reduce(s, b, from.data(), largest.data(), n, Larger(), -1);
    });
    EXPECT_EQ(sum.values()[0], std::accumulate(in.begin(), in.end(), 0ll));
    EXPECT_EQ(least.values()[0], *std::min_element(in.begin(), in.end()));
    EXPECT_EQ(largest.values()[0], *std::max_element(in.begin(), in.end()));
    in_two_phases(
        [&](void* s, std::size_t& b) { return cub::DeviceReduce::Max(s, b, from.data(), largest.data(), n); });
    EXPECT_EQ(largest.values()[0], *std::max_element(in.begin(), in.end()));
}

TEST_F(DevicePrimitive, selection_keeps_the_order) {
    const std::vector<int> in = some_integers(3000);
    const int n = static_cast<int>(in.size());
    std::vector<std::uint8_t> flags;
    std::vector<int> flagged, positive, unique = some_integers(3000, 3);
    for (std::size_t i = 0; i < in.size(); ++i) {
        flags.push_back(i % 3 == 0);
        if (i % 3 == 0) flagged.push_back(in[i]);
    }
    std::copy_if(in.begin(), in.end(), std::back_inserter(positive), Positive());
    const Array<int> from(in), repeated(unique), out(in.size()), count(1);
    const Array<std::uint8_t> device_flags(flags);
    const auto selected = [&] {
        std::vector<int> result = out.values();
        result.resize(static_cast<std::size_t>(count.values()[0]));
        return result;
    };
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceSelect::Flagged(s, b, from.data(), device_flags.data(), out.data(), count.data(), n);
    });
    EXPECT_EQ(selected(), flagged);
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceSelect::If(s, b, from.data(), out.data(), count.data(), n, Positive());
    });
    EXPECT_EQ(selected(), positive);
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceSelect::Unique(s, b, repeated.data(), out.data(), count.data(), n);
    });
    unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
    EXPECT_EQ(selected(), unique);
}

TEST_F(DevicePrimitive, runs_are_listed_with_their_lengths) {
    const std::vector<int> in = {4, 4, 4, 1, 7, 7, 4};
    const Array<int> from(in), items(in.size()), lengths(in.size()), runs(1);
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceRunLengthEncode::Encode(s, b, from.data(), items.data(), lengths.data(), runs.data(), 7);
    });
    EXPECT_EQ(runs.values()[0], 4);
    const std::vector<int> found = items.values(), long_ = lengths.values();
    EXPECT_EQ(std::vector<int>(found.begin(), found.begin() + 4), (std::vector<int>{4, 1, 7, 4}));
    EXPECT_EQ(std::vector<int>(long_.begin(), long_.begin() + 4), (std::vector<int>{3, 1, 2, 1}));
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceRunLengthEncode::NonTrivialRuns(s, b, from.data(), items.data(), lengths.data(), runs.data(),
                                                          7);
    });
    EXPECT_EQ(runs.values()[0], 2);
    EXPECT_EQ(items.values()[1], 4);
    EXPECT_EQ(lengths.values()[1], 2);
}

/// Returns the indices of the keys in the order of a stable sort.
template <class Key>
std::vector<int> sorted_indices(const std::vector<Key>& keys, int first, int last) {
    std::vector<int> result(static_cast<std::size_t>(last - first));
    std::iota(result.begin(), result.end(), first);
    std::stable_sort(result.begin(), result.end(), [&](int a, int b) {
        return keys[static_cast<std::size_t>(a)] < keys[static_cast<std::size_t>(b)];
    });
    return result;
}

TEST_F(DevicePrimitive, radix_sorts_are_stable_and_accept_a_range_of_bits) {
    std::vector<std::uint64_t> keys;
    for (const int x : some_integers(2000, 50))
        keys.push_back(static_cast<std::uint64_t>(x) << 20 | (static_cast<unsigned>(x) * 7919u % 128));
    std::vector<int> ids(keys.size());
    std::iota(ids.begin(), ids.end(), 0);
    const int n = static_cast<int>(keys.size());
    const Array<std::uint64_t> from(keys), sorted(keys.size()), other(keys.size());
    const Array<int> values(ids), sorted_values(ids.size()), other_values(ids.size());
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceRadixSort::SortPairs(s, b, from.data(), sorted.data(), values.data(), sorted_values.data(),
                                               n);
    });
    const std::vector<int> expected = sorted_indices(keys, 0, n);
    EXPECT_EQ(sorted_values.values(), expected);
    std::vector<std::uint64_t> expected_keys;
    for (const int i : expected) expected_keys.push_back(keys[static_cast<std::size_t>(i)]);
    EXPECT_EQ(sorted.values(), expected_keys);

    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceRadixSort::SortPairs(s, b, from.data(), sorted.data(), values.data(), sorted_values.data(), n,
                                               20, 22);
    });
    std::vector<unsigned> digits;
    for (const std::uint64_t key : keys) digits.push_back(static_cast<unsigned>(key >> 20 & 3));
    EXPECT_EQ(sorted_values.values(), sorted_indices(digits, 0, n));

    cub::DoubleBuffer<std::uint64_t> both(from.data(), other.data());
    cub::DoubleBuffer<int> both_values(values.data(), other_values.data());
    in_two_phases([&](void* s, std::size_t& b) { return cub::DeviceRadixSort::SortPairs(s, b, both, both_values, n); });
    std::vector<int> found(ids.size());
    check(cudaMemcpy(found.data(), both_values.Current(), found.size() * sizeof(int), cudaMemcpyDeviceToHost));
    EXPECT_EQ(found, expected);
}

TEST_F(DevicePrimitive, signed_and_floating_keys_sort_by_value) {
    const std::vector<float> keys = {3.5f, -1.0f, 0.25f, -100.0f, 1e30f, -1e-30f};
    const std::vector<int> numbers = {5, -3, 0, 2147483647, -2147483647 - 1, -4};
    const Array<float> from(keys), sorted(keys.size());
    const Array<int> in(numbers), out(numbers.size());
    in_two_phases(
        [&](void* s, std::size_t& b) { return cub::DeviceRadixSort::SortKeys(s, b, from.data(), sorted.data(), 6); });
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceRadixSort::SortKeysDescending(s, b, in.data(), out.data(), 6);
    });
    EXPECT_EQ(sorted.values(), (std::vector<float>{-100.0f, -1.0f, -1e-30f, 0.25f, 3.5f, 1e30f}));
    EXPECT_EQ(out.values(), (std::vector<int>{2147483647, 5, 0, -3, -4, -2147483647 - 1}));
}

TEST_F(DevicePrimitive, segments_are_sorted_separately) {
    const std::vector<int> keys = some_integers(1000, 20), offsets = {0, 10, 10, 400, 1000};
    std::vector<int> ids(keys.size()), expected;
    std::iota(ids.begin(), ids.end(), 0);
    for (std::size_t s = 0; s + 1 < offsets.size(); ++s) {
        const std::vector<int> segment = sorted_indices(keys, offsets[s], offsets[s + 1]);
        expected.insert(expected.end(), segment.begin(), segment.end());
    }
    const Array<int> from(keys), sorted(keys.size()), values(ids), sorted_values(ids.size()), begin(offsets);
    const auto clear = [&] { check(cudaMemset(sorted_values.data(), 0xff, ids.size() * sizeof(int))); };
    clear();
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceSegmentedRadixSort::SortPairs(s, b, from.data(), sorted.data(), values.data(),
                                                        sorted_values.data(), 1000, 4, begin.data(), begin.data() + 1);
    });
    EXPECT_EQ(sorted_values.values(), expected);
    clear();
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceSegmentedSort::StableSortPairs(s, b, from.data(), sorted.data(), values.data(),
                                                         sorted_values.data(), 1000, 4, begin.data(), begin.data() + 1);
    });
    EXPECT_EQ(sorted_values.values(), expected);
    in_two_phases([&](void* s, std::size_t& b) {
        return cub::DeviceSegmentedSort::SortPairs(s, b, from.data(), sorted.data(), values.data(),
                                                   sorted_values.data(), 1000, 4, begin.data(), begin.data() + 1);
    });
    // SortPairs is not stable: checks only that keys are in order and that each value is still with its key.
    const std::vector<int> found = sorted_values.values(), found_keys = sorted.values();
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found_keys[i], keys[static_cast<std::size_t>(expected[i])]);
        EXPECT_EQ(keys[static_cast<std::size_t>(found[i])], found_keys[i]);
    }
}

}  // namespace
