// Captures, graphs, and calls that a capture forbids.

#include <thread>

#include <cub/device/device_scan.cuh>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::check;
using portable::try_launch;

__global__ void step(int* x, int y) { *x = 3 * *x + y; }
__global__ void add(int* x, const int* y, int n) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < n) x[i] += y[i];
}

class Graph : public portable::DeviceTest {
   protected:
    void SetUp() override {
        DeviceTest::SetUp();
        if (IsSkipped()) return;
        check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
        check(cudaStreamCreateWithFlags(&other, cudaStreamNonBlocking));
        check(cudaEventCreateWithFlags(&fork, cudaEventDisableTiming));
        check(cudaEventCreateWithFlags(&join, cudaEventDisableTiming));
    }
    void TearDown() override {
        if (IsSkipped()) return;
        check(cudaStreamDestroy(stream));
        check(cudaStreamDestroy(other));
        check(cudaEventDestroy(fork));
        check(cudaEventDestroy(join));
        DeviceTest::TearDown();
    }
    void begin(cudaStreamCaptureMode mode = cudaStreamCaptureModeThreadLocal) {
        check(cudaStreamBeginCapture(stream, mode));
    }
    cudaGraph_t end() {
        cudaGraph_t graph = nullptr;
        check(cudaStreamEndCapture(stream, &graph));
        return graph;
    }
    /// Ends a capture that must have been invalidated, and clears the error.
    void expect_spoilt() {
        cudaGraph_t graph = nullptr;
        EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaErrorStreamCaptureInvalidated);
        EXPECT_EQ(graph, nullptr);
        cudaGetLastError();
    }
    /// Calls f(ask, spoils) for several calls of the runtime API: ask() makes the call, and `spoils` is true if it
    /// invalidates captures. f must repeat a call that is refused.
    template <class F>
    void for_each_call(F f) {
        cudaStream_t a_stream;
        check(cudaStreamCreateWithFlags(&a_stream, cudaStreamNonBlocking));
        f([&] { return cudaStreamDestroy(a_stream); }, false);
        cudaEvent_t event;
        check(cudaEventCreate(&event));
        f([&] { return cudaEventDestroy(event); }, false);
        const Array<int> x(1);
        f([&] { return cudaMemset(x.data(), 0, 4); }, false);
        begin();
        const cudaGraph_t graph = end();
        cudaGraphExec_t executable;
        check(cudaGraphInstantiate(&executable, graph, 0));
        check(cudaGraphDestroy(graph));
        f([&] { return cudaGraphExecDestroy(executable); }, true);
        f([&] { return cudaStreamSynchronize(other); }, true);
        f([&] { return cudaStreamQuery(other); }, true);
        check(cudaEventRecord(fork, other));
        check(cudaEventSynchronize(fork));
        f([&] { return cudaEventSynchronize(fork); }, true);
        f([&] { return cudaEventQuery(fork); }, true);
    }
    /// Ends a capture. It must have been invalidated if `spoilt`, and be valid otherwise.
    void expect_spoilt(bool spoilt) {
        if (spoilt)
            expect_spoilt();
        else
            check(cudaGraphDestroy(end()));
    }
    int read(const int* device) {
        int value = -1;
        check(cudaMemcpyAsync(&value, device, sizeof value, cudaMemcpyDeviceToHost, stream));
        check(cudaStreamSynchronize(stream));
        return value;
    }

    cudaStream_t stream = nullptr, other = nullptr;
    cudaEvent_t fork = nullptr, join = nullptr;
};

TEST_F(Graph, capture_runs_nothing_and_each_launch_runs_all_nodes) {
    const Array<int> x(std::vector<int>{1});
    begin();
    cudaStreamCaptureStatus status;
    check(cudaStreamIsCapturing(stream, &status));
    EXPECT_EQ(status, cudaStreamCaptureStatusActive);
    check(try_launch(stream, step, 1, 1, 0, x.data(), 1));
    check(try_launch(stream, step, 1, 1, 0, x.data(), 2));
    const cudaGraph_t graph = end();
    std::size_t nodes = 0;
    check(cudaGraphGetNodes(graph, nullptr, &nodes));
    EXPECT_EQ(nodes, 2u);
    cudaGraphExec_t executable;
    check(cudaGraphInstantiate(&executable, graph, 0));
    check(cudaGraphDestroy(graph));
    EXPECT_EQ(read(x.data()), 1);
    check(cudaGraphUpload(executable, stream));
    check(cudaGraphLaunch(executable, stream));
    EXPECT_EQ(read(x.data()), 14);
    check(cudaGraphLaunch(executable, stream));
    check(cudaGraphLaunch(executable, stream));
    EXPECT_EQ(read(x.data()), (14 * 9 + 5) * 9 + 5);
    check(cudaGraphExecDestroy(executable));
}

TEST_F(Graph, streams_of_a_capture_share_its_id) {
    const auto number = [](cudaStream_t of) {
        cudaStreamCaptureStatus status;
        unsigned long long id = 0;
        check(cudaStreamGetCaptureInfo(of, &status, &id));
        return status == cudaStreamCaptureStatusActive ? id : 0;
    };
    EXPECT_EQ(number(stream), 0u);
    begin();
    const unsigned long long first = number(stream);
    EXPECT_NE(first, 0u);
    EXPECT_EQ(number(other), 0u);
    check(cudaEventRecord(fork, stream));
    check(cudaStreamWaitEvent(other, fork, 0));
    EXPECT_EQ(number(other), first);
    check(cudaEventRecord(join, other));
    check(cudaStreamWaitEvent(stream, join, 0));
    check(cudaGraphDestroy(end()));
    EXPECT_EQ(number(other), 0u);
    begin();
    EXPECT_NE(number(stream), first);
    check(cudaGraphDestroy(end()));
}

TEST_F(Graph, copies_fills_and_scans_can_be_captured) {
    const int n = 1000;
    const Array<int> ones(n), sums(n);
    int* pinned = nullptr;
    check(cudaMallocHost(&pinned, n * sizeof(int)));
    std::size_t bytes = 0;
    check(cub::DeviceScan::InclusiveSum(nullptr, bytes, ones.data(), sums.data(), n, stream));
    const Array<char> storage(bytes);
    for (int i = 0; i < n; ++i) pinned[i] = 1;
    begin();
    check(cudaMemsetAsync(sums.data(), 0, n * sizeof(int), stream));
    check(cudaMemcpyAsync(ones.data(), pinned, n * sizeof(int), cudaMemcpyHostToDevice, stream));
    check(try_launch(stream, add, 4, 256, 0, sums.data(), static_cast<const int*>(ones.data()), n));
    check(cub::DeviceScan::InclusiveSum(storage.data(), bytes, sums.data(), ones.data(), n, stream));
    check(cudaMemcpyAsync(pinned, ones.data(), n * sizeof(int), cudaMemcpyDeviceToHost, stream));
    const cudaGraph_t graph = end();
    cudaGraphExec_t executable;
    check(cudaGraphInstantiate(&executable, graph, 0));
    check(cudaGraphLaunch(executable, stream));
    check(cudaStreamSynchronize(stream));
    for (int i = 0; i < n; ++i) EXPECT_EQ(pinned[i], i + 1);
    check(cudaGraphExecDestroy(executable));
    check(cudaGraphDestroy(graph));
    check(cudaFreeHost(pinned));
}

TEST_F(Graph, events_fork_and_join_streams_of_a_capture) {
    const Array<int> x(std::vector<int>{1}), y(std::vector<int>{2});
    begin();
    check(try_launch(stream, step, 1, 1, 0, x.data(), 1));
    check(cudaEventRecord(fork, stream));
    check(cudaStreamWaitEvent(other, fork, 0));
    check(try_launch(other, add, 1, 1, 0, y.data(), static_cast<const int*>(x.data()), 1));
    check(cudaEventRecord(join, other));
    check(cudaStreamWaitEvent(stream, join, 0));
    check(try_launch(stream, add, 1, 1, 0, x.data(), static_cast<const int*>(y.data()), 1));
    const cudaGraph_t graph = end();
    cudaGraphExec_t executable;
    check(cudaGraphInstantiate(&executable, graph, 0));
    check(cudaGraphLaunch(executable, stream));
    EXPECT_EQ(read(x.data()), 10);
    EXPECT_EQ(read(y.data()), 6);
    // The other stream no longer takes part in the capture.
    check(try_launch(other, step, 1, 1, 0, y.data(), 0));
    check(cudaStreamSynchronize(other));
    EXPECT_EQ(read(y.data()), 18);
    check(cudaGraphExecDestroy(executable));
    check(cudaGraphDestroy(graph));
}

TEST_F(Graph, updates_change_parameters_but_not_topology) {
    const Array<int> x(std::vector<int>{0});
    const auto capture = [&](int y, int steps) {
        begin();
        for (int i = 0; i < steps; ++i) check(try_launch(stream, step, 1, 1, 0, x.data(), y));
        return end();
    };
    const cudaGraph_t first = capture(1, 2), second = capture(5, 2), third = capture(1, 3);
    cudaGraphExec_t executable;
    check(cudaGraphInstantiate(&executable, first, 0));
    cudaGraphExecUpdateResultInfo info;
    EXPECT_EQ(cudaGraphExecUpdate(executable, third, &info), cudaErrorGraphExecUpdateFailure);
    EXPECT_EQ(info.result, cudaGraphExecUpdateErrorTopologyChanged);
    EXPECT_EQ(cudaGetLastError(), cudaErrorGraphExecUpdateFailure);
    check(cudaGraphLaunch(executable, stream));
    EXPECT_EQ(read(x.data()), 4);
    check(cudaGraphExecUpdate(executable, second, &info));
    EXPECT_EQ(info.result, cudaGraphExecUpdateSuccess);
    check(cudaGraphLaunch(executable, stream));
    EXPECT_EQ(read(x.data()), 56);
    check(cudaGraphExecDestroy(executable));
    for (const cudaGraph_t graph : {first, second, third}) check(cudaGraphDestroy(graph));
}

TEST_F(Graph, host_wait_or_allocation_invalidates_a_capture) {
    const Array<int> x(1);
    begin();
    EXPECT_EQ(cudaStreamSynchronize(stream), cudaErrorStreamCaptureUnsupported);
    expect_spoilt();
    begin();
    void* memory = nullptr;
    EXPECT_NE(cudaMalloc(&memory, 4), cudaSuccess);
    expect_spoilt();
    begin();
    EXPECT_NE(cudaDeviceSynchronize(), cudaSuccess);
    expect_spoilt();
    begin();
    EXPECT_NE(cudaStreamQuery(stream), cudaSuccess);
    expect_spoilt();
    // The stream works again.
    check(cudaMemsetAsync(x.data(), 0, 4, stream));
    EXPECT_EQ(read(x.data()), 0);
}

TEST_F(Graph, legacy_stream_copy_spares_captures_of_non_blocking_streams) {
    const Array<int> x(std::vector<int>{7});
    begin();
    int value = 0;
    check(cudaMemcpy(&value, x.data(), 4, cudaMemcpyDeviceToHost));
    EXPECT_EQ(value, 7);
    check(cudaGraphDestroy(end()));
}

TEST_F(Graph, capture_is_invalidated_only_by_calls_that_are_refused) {
    for_each_call([&](auto ask, bool spoils) {
        begin();
        const bool refused = ask() != cudaSuccess;
        EXPECT_EQ(refused, spoils);
        expect_spoilt(spoils);
        if (refused) check(ask());
    });
}

TEST_F(Graph, allocating_in_another_thread_invalidates_capture_only_if_both_are_global) {
    struct Case {
        cudaStreamCaptureMode capture, thread;
        bool minds;
    };
    for (const Case& c : {Case{cudaStreamCaptureModeGlobal, cudaStreamCaptureModeGlobal, true},
                          Case{cudaStreamCaptureModeGlobal, cudaStreamCaptureModeThreadLocal, false},
                          Case{cudaStreamCaptureModeGlobal, cudaStreamCaptureModeRelaxed, false},
                          Case{cudaStreamCaptureModeThreadLocal, cudaStreamCaptureModeGlobal, false}}) {
        SCOPED_TRACE(testing::Message() << "capture " << c.capture << ", thread " << c.thread);
        const Array<int> x(1);
        begin(c.capture);
        check(cudaMemsetAsync(x.data(), 0, 4, stream));
        cudaError_t allocated = cudaSuccess;
        cudaStreamCaptureMode mode = c.thread;
        std::thread([&] {
            EXPECT_EQ(cudaThreadExchangeStreamCaptureMode(&mode), cudaSuccess);
            void* memory = nullptr;
            allocated = cudaMalloc(&memory, 4);
            cudaFree(memory);
        }).join();
        EXPECT_EQ(mode, cudaStreamCaptureModeGlobal) << "what it was before";
        EXPECT_EQ(allocated, c.minds ? cudaErrorStreamCaptureUnsupported : cudaSuccess);
        expect_spoilt(c.minds);
        for_each_call([&](auto ask, bool spoils) {
            begin(c.capture);
            bool refused = false;
            mode = c.thread;
            std::thread([&] {
                EXPECT_EQ(cudaThreadExchangeStreamCaptureMode(&mode), cudaSuccess);
                refused = ask() != cudaSuccess;
            }).join();
            EXPECT_EQ(refused, c.minds && spoils);
            expect_spoilt(c.minds && spoils);
            if (refused) check(ask());
        });
    }
}

TEST_F(Graph, device_wait_in_relaxed_mode_invalidates_global_capture_of_another_thread) {
    begin(cudaStreamCaptureModeGlobal);
    std::thread([] {
        cudaStreamCaptureMode mode = cudaStreamCaptureModeRelaxed;
        check(cudaThreadExchangeStreamCaptureMode(&mode));
        EXPECT_EQ(cudaDeviceSynchronize(), cudaErrorStreamCaptureUnsupported);
    }).join();
    expect_spoilt();
}

TEST_F(Graph, a_relaxed_thread_may_allocate_and_destroy_while_it_captures) {
    const Array<int> x(1);
    begin();
    cudaStreamCaptureMode mode = cudaStreamCaptureModeRelaxed;
    check(cudaThreadExchangeStreamCaptureMode(&mode));
    void* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, 4), cudaSuccess);
    EXPECT_EQ(cudaFree(memory), cudaSuccess);
    check(cudaThreadExchangeStreamCaptureMode(&mode));
    EXPECT_EQ(mode, cudaStreamCaptureModeRelaxed);
    check(cudaGraphDestroy(end()));
    for_each_call([&](auto ask, bool) {
        begin();
        check(cudaThreadExchangeStreamCaptureMode(&mode));
        check(ask());
        check(cudaThreadExchangeStreamCaptureMode(&mode));
        check(cudaGraphDestroy(end()));
    });
}

TEST_F(Graph, a_fork_must_be_joined) {
    const Array<int> x(std::vector<int>{1});
    begin();
    check(try_launch(stream, step, 1, 1, 0, x.data(), 1));
    check(cudaEventRecord(fork, stream));
    check(cudaStreamWaitEvent(other, fork, 0));
    check(try_launch(other, step, 1, 1, 0, x.data(), 1));
    cudaGraph_t graph = nullptr;
    EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaErrorStreamCaptureUnjoined);
    EXPECT_EQ(graph, nullptr);
    EXPECT_EQ(cudaGetLastError(), cudaErrorStreamCaptureUnjoined);
}

TEST_F(Graph, a_capture_may_not_depend_on_work_outside) {
    const Array<int> x(1);
    check(cudaMemsetAsync(x.data(), 0, 4, other));
    check(cudaEventRecord(fork, other));
    begin();
    EXPECT_EQ(cudaStreamWaitEvent(stream, fork, 0), cudaErrorStreamCaptureIsolation);
    expect_spoilt();
    begin();
    check(cudaEventRecord(fork, stream));
    EXPECT_EQ(cudaEventSynchronize(fork), cudaErrorCapturedEvent);
    cudaGetLastError();
    cudaGraph_t graph = nullptr;
    cudaStreamEndCapture(stream, &graph);
    if (graph) check(cudaGraphDestroy(graph));
    cudaGetLastError();
    check(cudaStreamSynchronize(other));
}

TEST_F(Graph, legacy_stream_is_unusable_while_blocking_streams_capture) {
    cudaStream_t blocking;
    check(cudaStreamCreate(&blocking));
    const Array<int> x(1);
    for (const cudaStream_t legacy : {cudaStream_t{}, cudaStreamLegacy}) {
        check(cudaStreamBeginCapture(blocking, cudaStreamCaptureModeGlobal));
        cudaStreamCaptureStatus status;
        EXPECT_EQ(cudaStreamIsCapturing(legacy, &status), cudaErrorStreamCaptureImplicit);
        cudaGraph_t graph = nullptr;
        EXPECT_EQ(cudaStreamEndCapture(blocking, &graph), cudaSuccess) << "a query leaves it alone";
        check(cudaGraphDestroy(graph));
        check(cudaStreamBeginCapture(blocking, cudaStreamCaptureModeGlobal));
        EXPECT_EQ(cudaMemsetAsync(x.data(), 0, 4, legacy), cudaErrorStreamCaptureImplicit);
        EXPECT_EQ(cudaStreamEndCapture(blocking, &graph), cudaErrorStreamCaptureInvalidated);
        cudaGetLastError();
    }
    check(cudaStreamDestroy(blocking));
}

}  // namespace
