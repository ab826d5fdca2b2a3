// Tests that each planted bug is found, and that its kernel without the bug passes. The sections name what finds the
// bugs: the order of threads, the machine's own checks, or a sanitizer. In a build with ThreadSanitizer a race ends the
// process before its result could be wrong.

#include <cub/device/device_scan.cuh>
#include <cub/device/device_segmented_sort.cuh>
#include <functional>

#include "cuda_on_cpu/machine/sanitizers.h"
#include "cuda_on_cpu/machine/settings.h"
#include "cuda_on_cpu/tests/planted/kernels.cuh"
#include "cuda_on_cpu/tests/planted/planted.h"

#ifdef CUDA_ON_CPU_TSAN
// Ends the process at the first race in this executable.
extern "C" __attribute__((visibility("default"))) const char* __tsan_default_options() { return "halt_on_error=1"; }
#endif

namespace {

using namespace planted;
using cuda_on_cpu::Order;
using cuda_on_cpu::Progress;
using cuda_on_cpu::settings;
using portable::Array;
using portable::check;
using portable::launch;
using portable::try_launch;

constexpr Order all_orders[] = {Order::forward, Order::reverse, Order::random};
constexpr bool sanitized = cuda_on_cpu::address_sanitizer || cuda_on_cpu::thread_sanitizer;

/// Returns the results of a kernel of one block, one for each thread.
template <class T>
std::vector<T> run(void (*kernel)(T*, bool), bool bug, unsigned block = threads, std::size_t shared = 8192) {
    const Array<T> out(std::vector<T>(block, T{}));
    launch(kernel, 1, block, shared, out.data(), bug);
    return out.values();
}

enum class Racy { no, yes };

/// Expects, in each order, a wrong result with the bug and the right one without.
template <class T>
void expect_wrong(void (*kernel)(T*, bool), const std::vector<T>& right, Racy racy = Racy::no) {
    const auto block = static_cast<unsigned>(right.size());
    for (const Order order : all_orders) {
        settings().order = order;
        EXPECT_EQ(run(kernel, false, block), right);
        if (racy == Racy::yes && cuda_on_cpu::thread_sanitizer)
            EXPECT_DEATH(run(kernel, true, block), "data race");
        else
            EXPECT_NE(run(kernel, true, block), right) << "order " << static_cast<int>(order);
    }
}

/// Expects, in each order, that the machine refuses the bug with this message, and accepts the kernel without it.
template <class T>
void expect_refused(void (*kernel)(T*, bool), const char* message, unsigned block = threads) {
    for (const Order order : all_orders) {
        settings().order = order;
        EXPECT_DEATH(run(kernel, true, block), message);
        run(kernel, false, block);
    }
}

/// Expects that ThreadSanitizer finds the bug, in each order. The result is right in any order, so that no other build
/// finds it.
void expect_race(const std::function<void(bool)>& body) {
    for (const Order order : all_orders) {
        settings().order = order;
        body(false);
        if (cuda_on_cpu::thread_sanitizer)
            EXPECT_DEATH(body(true), "data race");
        else
            body(true);
    }
}

template <class F>
std::vector<int> each_thread(F f) {
    std::vector<int> result;
    for (int i = 0; i < threads; ++i) result.push_back(f(i));
    return result;
}

// Found by every order, and by ThreadSanitizer.

TEST_F(Planted, missing_barrier_between_write_and_read_is_found) {
    expect_wrong(mirror, each_thread([](int i) { return 10 * (threads - 1 - i); }), Racy::yes);
}
TEST_F(Planted, missing_barrier_between_read_and_next_write_is_found) {
    expect_wrong(mirror_in_a_loop, each_thread([](int i) { return 33 * (threads - 1 - i); }), Racy::yes);
}
TEST_F(Planted, warp_queue_read_without_fence_is_found) {
    expect_wrong(queue_of_bits, std::vector<unsigned>(32, 33), Racy::yes);
}

/// Returns the sum of worth() of all tests of a warp's pairs, for each of its lanes.
std::vector<unsigned> all_tests() {
    unsigned sum = 0;
    for (unsigned pair = 0; pair < 4; ++pair)
        for (unsigned kind = 0; kind < 2; ++kind)
            for (unsigned lane = 0; lane < 32; ++lane)
                sum += static_cast<unsigned>(__popc(tests_of_a_pair(pair, kind, lane))) * worth(kind, lane);
    return std::vector<unsigned>(32, sum);
}
TEST_F(Planted, queue_that_loses_its_last_items_is_found) {
    expect_wrong(queues_of_tests<QueueBug::lost_at_the_end>, all_tests());
}
TEST_F(Planted, queue_that_takes_one_item_too_many_is_found) {
    constexpr auto kernel = queues_of_tests<QueueBug::one_too_many>;
    if (cuda_on_cpu::address_sanitizer)
        expect_refused(kernel, "index 63 out of bounds", 32);
    else
        expect_wrong(kernel, all_tests());
}
TEST_F(Planted, block_barrier_relied_on_across_blocks_is_found) {
    settings().workers = 1;  // the bug is found even if one worker runs all blocks
    std::vector<Earliest> all;
    for (unsigned i = 0; i < 20 * threads; ++i) all.push_back({200 + i * 29 % 1000, i});
    all[700] = {100, 5001};
    all[900] = {100, 5000};
    const Array<Earliest> hits(all);
    const auto found = [&](bool bug) {
        const Array<Earliest> earliest(std::vector<Earliest>{{~0ull, ~0u}});
        const auto turn = [&](bool time, bool pair) {
            launch(find_earliest, 20, threads, 0, static_cast<const Earliest*>(hits.data()), earliest.data(), time,
                   pair);
        };
        turn(true, bug);
        if (!bug) turn(false, true);
        return earliest.values()[0].pair;
    };
    for (const Order order : all_orders) {
        settings().order = order;
        EXPECT_EQ(found(false), 5000u);
        if (cuda_on_cpu::thread_sanitizer)
            EXPECT_DEATH(found(true), "data race");
        else
            EXPECT_NE(found(true), 5000u) << "order " << static_cast<int>(order);
    }
}

// Found by every order, because undefined values are rubbish.

TEST_F(Planted, uninitialised_shared_memory_is_found) {
    expect_wrong(count_threads, std::vector<int>(threads, threads));
}
TEST_F(Planted, activemask_used_as_warp_mask_is_found) { expect_wrong(count_lanes, std::vector<int>(threads, 32)); }
TEST_F(Planted, shuffle_from_lane_outside_mask_is_found) {
    expect_wrong(read_first_lane, each_thread([](int i) { return i / 16 * 16; }));
}
TEST_F(Planted, block_reduction_used_by_all_threads_is_found) {
    expect_wrong(sum_for_all, std::vector<int>(threads, threads));
}
TEST_F(Planted, uninitialised_device_memory_holds_rubbish) {
    const Array<int> fresh(100);
    EXPECT_NE(fresh.values(), std::vector<int>(100, 0));
    const Array<int> other(100);
    EXPECT_NE(fresh.values(), other.values());
}

// Found by the machine, in every order.

TEST_F(Planted, mask_with_lanes_that_do_not_vote_is_refused) {
    expect_refused(even_lanes_vote, "exits while others wait for it in __ballot_sync|which do not exist or have exited",
                   32);
}
TEST_F(Planted, lanes_that_read_a_flag_separately_are_refused) {
    expect_refused(stop_at_a_flag, "exits while others wait for it in __ballot_sync|which do not exist or have exited");
}
TEST_F(Planted, lanes_that_skip_a_vote_are_refused) {
    expect_refused(leave_out_a_world,
                   "exits while others wait for it in __ballot_sync|which do not exist or have exited");
}
TEST_F(Planted, queue_counted_only_by_lanes_that_add_is_refused) {
    expect_refused(queues_of_tests<QueueBug::counted_by_those_that_add>, "is in deadlock|while others wait|data race",
                   32);
}
TEST_F(Planted, mask_without_the_caller_is_refused) {
    expect_refused(a_lane_not_named_votes, "the mask lacks the caller, lane 3", 32);
}
TEST_F(Planted, mask_with_lanes_that_do_not_exist_is_refused) {
    expect_refused(partial_warp_votes, "the mask names lanes 0xffff0000, which do not exist", 80);
}
TEST_F(Planted, different_masks_for_one_vote_are_refused) {
    expect_refused(halves_disagree, "while others wait for it in __ballot_sync|is in deadlock", 32);
}
TEST_F(Planted, barriers_in_two_branches_are_refused) {
    expect_refused(two_barriers,
                   "is in __syncthreads at .*kernels.cuh:[0-9]* while others of its block wait in __syncthreads");
}
TEST_F(Planted, exit_before_a_barrier_is_refused) {
    expect_refused(leave_early,
                   "exits while others wait for it in __syncthreads|threads that have exited will never reach");
}
TEST_F(Planted, barrier_where_others_vote_is_refused) { expect_refused(barrier_instead_of_vote, "is in deadlock"); }
TEST_F(Planted, endless_spinning_is_reported_as_deadlock) {
    settings().spin_seconds = 0.2;
    const Array<unsigned> flag(std::vector<unsigned>{0});
    EXPECT_DEATH(
        {
            launch(wait_for_flag, 1, 32, 0, flag.data(), true);
            cudaDeviceSynchronize();
        },
        "spin in __nanosleep");
    launch(wait_for_flag, 1, 32, 0, flag.data(), false);
    check(cudaDeviceSynchronize());
}
TEST_F(Planted, too_little_shared_memory_is_refused) {
    EXPECT_DEATH(run(mirror, false, threads, sizeof(Items) - 1),
                 "requests 256 bytes of dynamic shared memory.*launch has 255");
}
TEST_F(Planted, block_primitive_for_another_block_size_is_refused) {
    const Array<int> out(128);
    EXPECT_DEATH(
        {
            launch(scan_of_64, 1, 128, 1024, out.data());
            cudaDeviceSynchronize();
        },
        "BlockScan at .* is for 64 threads, but the block has 128");
}

// Found by guard pages and canaries or, in builds with AddressSanitizer, to the byte.

void write_shared_at(int index) {
    const Array<int> out(threads);
    launch(write_shared, 1, threads, sizeof(Items), out.data(), index);
    check(cudaDeviceSynchronize());
}
TEST_F(Planted, write_outside_shared_memory_is_found) {
    write_shared_at(threads - 1);
    EXPECT_DEATH(write_shared_at(threads),
                 sanitized ? "Sanitizer|runtime error" : "past the end of its 256 bytes of shared memory");
    if (cuda_on_cpu::thread_sanitizer) return;
    EXPECT_DEATH(write_shared_at(-1),
                 sanitized ? "AddressSanitizer|runtime error" : "wrote .* bytes before its shared memory");
}
TEST_F(Planted, undefined_behaviour_sanitizer_finds_array_overrun_in_shared_memory) {
    const auto body = [](int index) {
        const Array<int> out(threads);
        launch(write_array_in_shared, 1, threads, sizeof(TwoArrays), out.data(), index);
        check(cudaDeviceSynchronize());
    };
    body(threads - 1);
    if (!cuda_on_cpu::address_sanitizer) GTEST_SKIP() << "found by UndefinedBehaviorSanitizer";
    EXPECT_DEATH(body(threads), "index 64 out of bounds");
}

void write_global_at(long long index) {
    const Array<int> out(100);
    launch(write_global, 1, 1, 0, out.data(), index);
    check(cudaDeviceSynchronize());
}
TEST_F(Planted, write_past_a_device_allocation_is_found) {
    write_global_at(99);
    EXPECT_DEATH(write_global_at(128),
                 sanitized ? "Sanitizer" : "112 bytes past the end of an allocation of 400 bytes");
    EXPECT_DEATH(write_global_at(100), cuda_on_cpu::address_sanitizer
                                           ? "heap-buffer-overflow"
                                           : "memory 0 bytes past the end of an allocation of 400 bytes was written");
}
TEST_F(Planted, write_to_freed_device_memory_is_found) {
    const auto body = [] {
        int* memory = nullptr;
        check(cudaMalloc(&memory, 400));
        check(cudaFree(memory));
        launch(write_global, 1, 1, 0, memory, 7ll);
        check(cudaDeviceSynchronize());
    };
    EXPECT_DEATH(body(), sanitized ? "heap-use-after-free|SEGV" : "byte 28 of a freed allocation of 400 bytes");
}
TEST_F(Planted, write_before_the_stream_allocates_memory_is_found) {
    const auto body = [](bool bug) {
        cudaStream_t first, second;
        check(cudaStreamCreateWithFlags(&first, cudaStreamNonBlocking));
        check(cudaStreamCreateWithFlags(&second, cudaStreamNonBlocking));
        int* memory = nullptr;
        check(cudaMallocAsync(&memory, 400, first));
        check(try_launch(bug ? second : first, write_global, 1, 1, 0, memory, 7ll));
        check(cudaStreamSynchronize(bug ? second : first));
        check(cudaFreeAsync(memory, first));
        check(cudaStreamDestroy(first));
        check(cudaStreamDestroy(second));
    };
    body(false);
    EXPECT_DEATH(body(true), sanitized ? "use-after-poison|SEGV" : "byte 28 of a pending stream-ordered allocation");
}
TEST_F(Planted, stack_overflow_is_found) {
    const auto body = [](int depth) {
        const Array<int> out(1);
        launch(recurse, 1, 1, 0, out.data(), depth);
        check(cudaDeviceSynchronize());
    };
    body(10);
    // Under ThreadSanitizer the process ends without a message.
    EXPECT_DEATH(body(100000), cuda_on_cpu::thread_sanitizer    ? ""
                               : cuda_on_cpu::address_sanitizer ? "stack-overflow"
                                                                : "overflows its stack");
}
TEST_F(Planted, too_small_temporary_storage_is_refused) {
    const Array<int> data(1000);
    std::size_t bytes = 0;
    check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, data.data(), data.data(), 1000));
    const Array<char> less(bytes - 1);
    EXPECT_DEATH(cub::DeviceScan::ExclusiveSum(less.data(), bytes, data.data(), data.data(), 1000),
                 "temporary storage .* does not lie in one allocation");
}
TEST_F(Planted, unstable_sort_reorders_equal_keys) {
    const std::vector<int> ids = {0, 1, 2, 3};
    const Array<int> keys(std::vector<int>(4, 7)), keys_out(4), values(ids), values_out(4);
    const Array<int> offsets(std::vector<int>{0, 4});
    const auto sort = [&](void* storage, std::size_t& bytes) {
        check(cub::DeviceSegmentedSort::SortPairs(storage, bytes, keys.data(), keys_out.data(), values.data(),
                                                  values_out.data(), 4, 1, offsets.data(), offsets.data() + 1));
    };
    std::size_t bytes = 0;
    sort(nullptr, bytes);
    const Array<char> storage(bytes);
    sort(storage.data(), bytes);
    EXPECT_NE(values_out.values(), ids);
}
TEST_F(Planted, destroyed_handles_are_refused) {
    cudaStream_t stream;
    cudaEvent_t event;
    check(cudaStreamCreate(&stream));
    check(cudaEventCreate(&event));
    check(cudaStreamDestroy(stream));
    check(cudaEventDestroy(event));
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaErrorInvalidResourceHandle);
    EXPECT_EQ(cudaEventRecord(event, nullptr), cudaErrorInvalidResourceHandle);
}
TEST_F(Planted, second_free_of_memory_is_refused) {
    int* memory = nullptr;
    check(cudaMalloc(&memory, 400));
    check(cudaFree(memory));
    EXPECT_EQ(cudaFree(memory), cudaErrorInvalidValue);
}
TEST_F(Planted, invalid_copies_and_fills_are_refused) {
    const Array<int> memory(100);
    std::vector<int> host(101);
    EXPECT_EQ(cudaMemcpy(memory.data(), host.data(), 404, cudaMemcpyHostToDevice), cudaErrorInvalidValue);
    EXPECT_EQ(cudaMemcpy(host.data(), memory.data(), 400, cudaMemcpyHostToDevice), cudaErrorInvalidValue)
        << "direction";
    EXPECT_EQ(cudaMemset(host.data(), 0, 4), cudaErrorInvalidValue) << "host memory";
}
TEST_F(Planted, undefined_behaviour_sanitizer_finds_misaligned_vector_load) {
    const Array<float> in(std::vector<float>(8, 1.0f)), out(1);
    const auto body = [&](int offset) {
        launch(load_four, 1, 1, 0, static_cast<const float*>(in.data()), out.data(), offset);
        check(cudaDeviceSynchronize());
    };
    body(4);
    if (!cuda_on_cpu::address_sanitizer) GTEST_SKIP() << "found by UndefinedBehaviorSanitizer";
    EXPECT_DEATH(body(1), "misaligned address");
}

// Found by ThreadSanitizer alone.

TEST_F(Planted, only_thread_sanitizer_finds_ballot_used_as_a_fence) {
    expect_race([](bool bug) { EXPECT_EQ(run(neighbour, bug), each_thread([](int i) { return 10 * (i ^ 1); })); });
}
TEST_F(Planted, only_thread_sanitizer_finds_warp_queue_rewritten_without_fence) {
    expect_race([](bool bug) { EXPECT_EQ(run(queues_of_tests<QueueBug::read_while_written>, bug, 32), all_tests()); });
}
TEST_F(Planted, only_thread_sanitizer_finds_race_between_blocks) {
    settings().workers = 1;  // the race is found even if one worker runs all blocks
    expect_race([](bool bug) {
        const Array<int> count(std::vector<int>{0});
        launch(count_blocks, 20, threads, 0, count.data(), bug);
        EXPECT_EQ(count.values()[0], 20);
    });
}
TEST_F(Planted, only_thread_sanitizer_finds_missing_fence_between_blocks) {
    expect_race([](bool bug) {
        const Array<int> parts(20), total(1);
        const Array<unsigned> arrived(std::vector<unsigned>{0});
        launch(last_block_sums, 20, threads, 0, parts.data(), arrived.data(), total.data(), bug);
        EXPECT_EQ(total.values()[0], 210);
    });
}
TEST_F(Planted, only_thread_sanitizer_finds_missing_or_early_fence_before_last_warp) {
    for (const FenceBug planted : {FenceBug::missing, FenceBug::too_early})
        expect_race([&](bool bug) {
            const Array<unsigned> count(std::vector<unsigned>(32, 0)), arrived(std::vector<unsigned>{0}), total(1);
            launch(last_warp_of_a_list_sums, 20, threads, 0, count.data(), arrived.data(), total.data(),
                   bug ? planted : FenceBug::none);
            EXPECT_EQ(total.values()[0], 20u * threads);
        });
}
TEST_F(Planted, only_thread_sanitizer_finds_early_reuse_of_block_primitive_storage) {
    expect_race([](bool bug) { EXPECT_EQ(run(two_scans, bug), each_thread([](int i) { return 3 * i; })); });
}

}  // namespace
