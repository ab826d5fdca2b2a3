// Streams, events, launches.

#include <chrono>
#include <thread>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::check;
using portable::try_launch;

class Stream : public portable::DeviceTest {};

class OwnStream {
   public:
    explicit OwnStream(unsigned flags = cudaStreamNonBlocking) { check(cudaStreamCreateWithFlags(&stream_, flags)); }
    OwnStream(const OwnStream&) = delete;
    OwnStream& operator=(const OwnStream&) = delete;
    ~OwnStream() { cudaStreamDestroy(stream_); }
    operator cudaStream_t() const { return stream_; }

   private:
    cudaStream_t stream_ = nullptr;
};

/// Sets x to 3 x + y.
__global__ void step(int* x, int y) { *x = 3 * *x + y; }

int read(const int* device, cudaStream_t stream) {
    int value = -1;
    check(cudaMemcpyAsync(&value, device, sizeof value, cudaMemcpyDeviceToHost, stream));
    check(cudaStreamSynchronize(stream));
    return value;
}

TEST_F(Stream, work_is_done_in_order) {
    const OwnStream stream;
    const Array<int> x(1);
    check(cudaMemsetAsync(x.data(), 0, 4, stream));
    int expected = 0;
    for (int y = 1; y < 10; ++y) {
        check(try_launch(stream, step, 1, 1, 0, x.data(), y));
        expected = 3 * expected + y;
    }
    EXPECT_EQ(read(x.data(), stream), expected);
}

TEST_F(Stream, an_event_makes_one_stream_wait_for_another) {
    const OwnStream first, second;
    cudaEvent_t event;
    check(cudaEventCreateWithFlags(&event, cudaEventDisableTiming));
    const Array<int> x(1);
    check(cudaMemsetAsync(x.data(), 0, 4, first));
    check(try_launch(first, step, 1, 1, 0, x.data(), 1));
    check(cudaEventRecord(event, first));
    check(cudaStreamWaitEvent(second, event, 0));
    check(try_launch(second, step, 1, 1, 0, x.data(), 1));
    EXPECT_EQ(read(x.data(), second), 4);
    check(cudaEventDestroy(event));
}

TEST_F(Stream, the_legacy_stream_and_blocking_streams_wait_for_each_other) {
    const OwnStream stream(cudaStreamDefault);
    const Array<int> x(1);
    check(cudaMemsetAsync(x.data(), 0, 4, stream));
    check(try_launch(nullptr, step, 1, 1, 0, x.data(), 1));
    check(try_launch(stream, step, 1, 1, 0, x.data(), 2));
    check(try_launch(nullptr, step, 1, 1, 0, x.data(), 3));
    EXPECT_EQ(read(x.data(), stream), 18);
}

TEST_F(Stream, timed_events_report_elapsed_time_and_untimed_ones_do_not) {
    const OwnStream stream;
    const Array<int> x(1);
    cudaEvent_t begin, end, untimed;
    check(cudaEventCreate(&begin));
    check(cudaEventCreate(&end));
    check(cudaEventCreateWithFlags(&untimed, cudaEventDisableTiming));
    EXPECT_EQ(cudaEventQuery(begin), cudaSuccess) << "never recorded";
    check(cudaEventRecord(begin, stream));
    check(cudaMemsetAsync(x.data(), 0, 4, stream));
    check(try_launch(stream, step, 1, 1, 0, x.data(), 1));
    check(cudaLaunchHostFunc(
        stream, [](void*) { std::this_thread::sleep_for(std::chrono::milliseconds(10)); }, nullptr));
    check(cudaEventRecord(end, stream));
    check(cudaEventSynchronize(end));
    EXPECT_EQ(cudaEventQuery(begin), cudaSuccess);
    float milliseconds = -1;
    check(cudaEventElapsedTime(&milliseconds, begin, end));
    EXPECT_GE(milliseconds, 9.0f);
    EXPECT_LT(milliseconds, 10000.0f);
    EXPECT_NE(cudaEventElapsedTime(&milliseconds, begin, untimed), cudaSuccess);
    EXPECT_NE(cudaGetLastError(), cudaSuccess);
    for (const cudaEvent_t event : {begin, end, untimed}) check(cudaEventDestroy(event));
}

TEST_F(Stream, polling_makes_progress) {
    const OwnStream stream;
    const Array<int> x(1);
    cudaEvent_t event;
    check(cudaEventCreate(&event));
    check(cudaMemsetAsync(x.data(), 0, 4, stream));
    for (int y = 0; y < 5; ++y) check(try_launch(stream, step, 1, 1, 0, x.data(), y));
    check(cudaEventRecord(event, stream));
    cudaError_t state;
    while ((state = cudaEventQuery(event)) == cudaErrorNotReady) cudaGetLastError();
    EXPECT_EQ(state, cudaSuccess);
    while ((state = cudaStreamQuery(stream)) == cudaErrorNotReady) cudaGetLastError();
    EXPECT_EQ(state, cudaSuccess);
    check(cudaEventDestroy(event));
}

TEST_F(Stream, pinned_memory_is_accessed_in_stream_order) {
    const OwnStream stream;
    int* pinned = nullptr;
    check(cudaMallocHost(&pinned, 2 * sizeof(int)));
    pinned[0] = 5;
    const Array<int> x(1);
    check(cudaMemcpyAsync(x.data(), &pinned[0], 4, cudaMemcpyHostToDevice, stream));
    check(try_launch(stream, step, 1, 1, 0, x.data(), 2));
    check(cudaMemcpyAsync(&pinned[1], x.data(), 4, cudaMemcpyDeviceToHost, stream));
    check(cudaStreamSynchronize(stream));
    EXPECT_EQ(pinned[1], 17);
    check(cudaFreeHost(pinned));
}

TEST_F(Stream, host_functions_run_in_stream_order) {
    const OwnStream stream;
    int* pinned = nullptr;
    check(cudaMallocHost(&pinned, sizeof(int)));
    const Array<int> x(std::vector<int>{1});
    check(cudaMemcpyAsync(pinned, x.data(), 4, cudaMemcpyDeviceToHost, stream));
    check(cudaLaunchHostFunc(
        stream, [](void* p) { *static_cast<int*>(p) += 41; }, pinned));
    check(cudaMemcpyAsync(x.data(), pinned, 4, cudaMemcpyHostToDevice, stream));
    EXPECT_EQ(read(x.data(), stream), 42);
    check(cudaFreeHost(pinned));
}

TEST_F(Stream, several_host_threads_may_use_streams) {
    std::vector<std::thread> threads;
    std::vector<int> found(4);
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([t, &found] {
            const OwnStream stream;
            const Array<int> x(std::vector<int>{t});
            for (int y = 0; y < 3; ++y) check(try_launch(stream, step, 1, 1, 0, x.data(), y));
            found[static_cast<std::size_t>(t)] = read(x.data(), stream);
        });
    for (std::thread& thread : threads) thread.join();
    for (int t = 0; t < 4; ++t) EXPECT_EQ(found[static_cast<std::size_t>(t)], 27 * t + 5);
}

TEST_F(Stream, kernels_report_attributes_and_occupancy) {
    cudaFuncAttributes attributes;
    check(cudaFuncGetAttributes(&attributes, step));
    EXPECT_GE(attributes.maxThreadsPerBlock, 256);
    int blocks = 0;
    check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, step, 256, 16 << 10));
    EXPECT_GT(blocks, 0);
}

}  // namespace
