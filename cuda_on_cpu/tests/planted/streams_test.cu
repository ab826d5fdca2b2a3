// Planted bugs in host code: streams, graphs, captures.

#include <thread>

#include "cuda_on_cpu/tests/planted/planted.h"
#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using cuda_on_cpu::Order;
using cuda_on_cpu::Progress;
using cuda_on_cpu::settings;
using planted::Planted;
using portable::Array;
using portable::check;
using portable::try_launch;

__global__ void copy(int* to, const int* from) { *to = *from; }
__global__ void set(int* to, int value) { *to = value; }

// Found by lazy streams.

struct TwoStreams {
    cudaStream_t first = nullptr, second = nullptr;
    cudaEvent_t event = nullptr;
    TwoStreams() {
        check(cudaStreamCreateWithFlags(&first, cudaStreamNonBlocking));
        check(cudaStreamCreateWithFlags(&second, cudaStreamNonBlocking));
        check(cudaEventCreate(&event));
    }
    ~TwoStreams() {
        cudaStreamDestroy(first);
        cudaStreamDestroy(second);
        cudaEventDestroy(event);
    }
};

TEST_F(Planted, lazy_streams_show_missing_wait_between_streams) {
    const auto body = [](bool bug) {
        const TwoStreams s;
        const Array<int> from(std::vector<int>{1}), to(std::vector<int>{1});
        check(try_launch(s.first, set, 1, 1, 0, from.data(), 2));
        check(cudaEventRecord(s.event, s.first));
        if (!bug) check(cudaStreamWaitEvent(s.second, s.event, 0));
        check(try_launch(s.second, copy, 1, 1, 0, to.data(), static_cast<const int*>(from.data())));
        check(cudaStreamSynchronize(s.second));
        int result = 0;
        check(cudaMemcpy(&result, to.data(), 4, cudaMemcpyDeviceToHost));
        return result;
    };
    EXPECT_EQ(body(false), 2);
    EXPECT_EQ(body(true), 1);
    settings().progress = Progress::eager;
    EXPECT_EQ(body(true), 2) << "hidden by eager streams";
}
TEST_F(Planted, lazy_streams_show_missing_wait_for_a_copy) {
    int* pinned = nullptr;
    check(cudaMallocHost(&pinned, 4));
    const auto body = [&](bool bug) {
        const TwoStreams s;
        const Array<int> from(std::vector<int>{7});
        *pinned = 0;
        check(cudaMemcpyAsync(pinned, from.data(), 4, cudaMemcpyDeviceToHost, s.first));
        if (!bug) check(cudaStreamSynchronize(s.first));
        return *pinned;
    };
    EXPECT_EQ(body(false), 7);
    EXPECT_EQ(body(true), 0);
    check(cudaFreeHost(pinned));
}

// Found by eager streams.

// Launches write results for the host to two slots in turn, because the next launch runs before the host reads the
// first result. Planted: both launches write the same slot.
TEST_F(Planted, eager_streams_show_result_overwritten_by_next_launch) {
    int* slots = nullptr;
    check(cudaMallocHost(&slots, 8));
    const auto first_answer = [&](bool bug) {
        const TwoStreams s;
        cudaEvent_t second = nullptr;
        check(cudaEventCreate(&second));
        check(try_launch(s.first, set, 1, 1, 0, &slots[0], 1));
        check(cudaEventRecord(s.event, s.first));
        check(try_launch(s.first, set, 1, 1, 0, &slots[bug ? 0 : 1], 2));
        check(cudaEventRecord(second, s.first));
        check(cudaEventSynchronize(s.event));
        const int answer = slots[0];
        check(cudaEventSynchronize(second));
        check(cudaEventDestroy(second));
        return answer;
    };
    EXPECT_EQ(first_answer(false), 1);
    EXPECT_EQ(first_answer(true), 1) << "hidden by lazy streams";
    settings().progress = Progress::eager;
    EXPECT_EQ(first_answer(false), 1);
    EXPECT_EQ(first_answer(true), 2);
    check(cudaFreeHost(slots));
}

// Found by the order of a graph's nodes.

TEST_F(Planted, reverse_order_shows_missing_dependency_in_a_graph) {
    const auto body = [](bool bug) {
        const TwoStreams s;
        const Array<int> from(std::vector<int>{1}), to(std::vector<int>{1});
        check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
        check(cudaEventRecord(s.event, s.first));
        check(cudaStreamWaitEvent(s.second, s.event, 0));
        check(try_launch(s.second, set, 1, 1, 0, from.data(), 2));
        check(cudaEventRecord(s.event, s.second));
        if (!bug) check(cudaStreamWaitEvent(s.first, s.event, 0));
        check(try_launch(s.first, copy, 1, 1, 0, to.data(), static_cast<const int*>(from.data())));
        if (bug) check(cudaStreamWaitEvent(s.first, s.event, 0));
        cudaGraph_t graph;
        check(cudaStreamEndCapture(s.first, &graph));
        cudaGraphExec_t executable;
        check(cudaGraphInstantiate(&executable, graph, 0));
        check(cudaGraphLaunch(executable, s.first));
        check(cudaStreamSynchronize(s.first));
        check(cudaGraphExecDestroy(executable));
        check(cudaGraphDestroy(graph));
        return to.values()[0];
    };
    EXPECT_EQ(body(false), 2);
    EXPECT_EQ(body(true), 2) << "hidden by forward order";
    settings().order = Order::reverse;
    EXPECT_EQ(body(false), 2);
    EXPECT_EQ(body(true), 1);
}
// A branch of a graph writes the input of the next launch. Planted: it overwrites the input of the current one.
TEST_F(Planted, reverse_order_shows_branch_that_overwrites_input_of_other_nodes) {
    const auto body = [](bool bug) {
        const TwoStreams s;
        const Array<int> now(std::vector<int>{0}), next(std::vector<int>{1}), to(std::vector<int>{0});
        check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
        check(try_launch(s.first, copy, 1, 1, 0, now.data(), static_cast<const int*>(next.data())));
        check(cudaEventRecord(s.event, s.first));
        check(cudaStreamWaitEvent(s.second, s.event, 0));
        check(try_launch(s.first, copy, 1, 1, 0, to.data(), static_cast<const int*>(now.data())));
        check(try_launch(s.second, set, 1, 1, 0, bug ? now.data() : next.data(), 2));
        check(cudaEventRecord(s.event, s.second));
        check(cudaStreamWaitEvent(s.first, s.event, 0));
        cudaGraph_t graph;
        check(cudaStreamEndCapture(s.first, &graph));
        cudaGraphExec_t executable;
        check(cudaGraphInstantiate(&executable, graph, 0));
        check(cudaGraphLaunch(executable, s.first));
        check(cudaStreamSynchronize(s.first));
        check(cudaGraphExecDestroy(executable));
        check(cudaGraphDestroy(graph));
        return to.values()[0];
    };
    EXPECT_EQ(body(false), 1);
    EXPECT_EQ(body(true), 1) << "hidden by forward order";
    settings().order = Order::reverse;
    EXPECT_EQ(body(false), 1);
    EXPECT_EQ(body(true), 2);
}

// Found by the default settings.

// A graph is updated to the address of the current frame's array. Planted: it is not updated, or only after its launch.
TEST_F(Planted, graph_with_outdated_array_address_is_found) {
    enum { updates, never, too_late };
    const auto body = [](int when) {
        const TwoStreams s;
        const Array<int> before(std::vector<int>{1}), now(std::vector<int>{2}), to(std::vector<int>{0});
        const auto capture = [&](const int* from) {
            check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
            check(try_launch(s.first, copy, 1, 1, 0, to.data(), from));
            cudaGraph_t graph;
            check(cudaStreamEndCapture(s.first, &graph));
            return graph;
        };
        const cudaGraph_t first = capture(before.data()), second = capture(now.data());
        cudaGraphExec_t executable;
        check(cudaGraphInstantiate(&executable, first, 0));
        const auto update = [&] {
            cudaGraphExecUpdateResultInfo result;
            check(cudaGraphExecUpdate(executable, second, &result));
        };
        if (when == updates) update();
        check(cudaGraphLaunch(executable, s.first));
        if (when == too_late) update();  // the launch keeps the old address
        check(cudaStreamSynchronize(s.first));
        check(cudaGraphExecDestroy(executable));
        for (const cudaGraph_t graph : {first, second}) check(cudaGraphDestroy(graph));
        return to.values()[0];
    };
    EXPECT_EQ(body(updates), 2);
    EXPECT_EQ(body(never), 1);
    EXPECT_EQ(body(too_late), 1);
}
TEST_F(Planted, host_round_trip_in_a_capture_is_refused) {
    const TwoStreams s;
    check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
    EXPECT_EQ(cudaStreamSynchronize(s.first), cudaErrorStreamCaptureUnsupported);
    cudaGraph_t graph;
    EXPECT_EQ(cudaStreamEndCapture(s.first, &graph), cudaErrorStreamCaptureInvalidated);
    check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
    const Array<int>* never = nullptr;
    EXPECT_THROW(never = new Array<int>(4), std::runtime_error) << "cudaMalloc";
    EXPECT_EQ(never, nullptr);
    EXPECT_EQ(cudaStreamEndCapture(s.first, &graph), cudaErrorStreamCaptureInvalidated);
}
// A library switches its caller's thread to relaxed mode during a call, so that it may allocate. Planted: the thread is
// still relaxed while the library records commands in a caller's capture, where allocations by mistake go unseen.
TEST_F(Planted, allocation_in_capture_is_refused_unless_relaxed) {
    const TwoStreams s;
    const auto allocates_in_capture = [&](bool bug) {
        check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
        cudaStreamCaptureMode called = cudaStreamCaptureModeRelaxed, within = cudaStreamCaptureModeThreadLocal;
        check(cudaThreadExchangeStreamCaptureMode(&called));
        if (!bug) check(cudaThreadExchangeStreamCaptureMode(&within));
        void* memory = nullptr;
        const bool allocated = cudaMalloc(&memory, 4) == cudaSuccess;
        if (!bug) check(cudaThreadExchangeStreamCaptureMode(&within));
        check(cudaThreadExchangeStreamCaptureMode(&called));
        cudaGraph_t graph = nullptr;
        const bool sound = cudaStreamEndCapture(s.first, &graph) == cudaSuccess;
        if (graph) check(cudaGraphDestroy(graph));
        cudaFree(memory);
        cudaGetLastError();
        return std::pair(allocated, sound);
    };
    EXPECT_EQ(allocates_in_capture(false), std::pair(false, false));
    EXPECT_EQ(allocates_in_capture(true), std::pair(true, true)) << "hidden";
}
// A library destroys a cached executable graph while its caller, or another thread, captures. Planted: the library's
// thread is not in relaxed mode.
TEST_F(Planted, destroying_executable_invalidates_captures_unless_relaxed) {
    const TwoStreams s;
    const auto leaves_capture_alone = [&](bool bug, bool in_another_thread) {
        check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
        cudaGraph_t empty = nullptr;
        check(cudaStreamEndCapture(s.first, &empty));
        cudaGraphExec_t kept = nullptr;
        check(cudaGraphInstantiate(&kept, empty, 0));
        check(cudaGraphDestroy(empty));
        const auto destroy = [&] {
            cudaStreamCaptureMode mode = bug ? cudaStreamCaptureModeGlobal : cudaStreamCaptureModeRelaxed;
            check(cudaThreadExchangeStreamCaptureMode(&mode));
            const bool destroyed = cudaGraphExecDestroy(kept) == cudaSuccess;
            check(cudaThreadExchangeStreamCaptureMode(&mode));
            return destroyed;
        };
        check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeGlobal));
        bool destroyed = false;
        if (in_another_thread)
            std::thread([&] { destroyed = destroy(); }).join();
        else
            destroyed = destroy();
        cudaGraph_t graph = nullptr;
        const bool sound = cudaStreamEndCapture(s.first, &graph) == cudaSuccess;
        if (graph) check(cudaGraphDestroy(graph));
        if (!destroyed) check(cudaGraphExecDestroy(kept));
        cudaGetLastError();
        return sound;
    };
    for (const bool in_another_thread : {false, true}) {
        EXPECT_TRUE(leaves_capture_alone(false, in_another_thread));
        EXPECT_FALSE(leaves_capture_alone(true, in_another_thread));
    }
}
TEST_F(Planted, empty_fill_in_a_capture_is_refused) {
    const TwoStreams s;
    const Array<int> memory(4);
    const auto set = [&](std::size_t bytes) { return cudaMemsetAsync(memory.data(), 0, bytes, s.first); };
    EXPECT_EQ(set(0), cudaSuccess) << "outside of a capture";
    check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
    EXPECT_EQ(set(4), cudaSuccess);
    EXPECT_EQ(set(0), cudaErrorInvalidValue);
    cudaGraph_t graph;
    EXPECT_EQ(cudaStreamEndCapture(s.first, &graph), cudaErrorStreamCaptureInvalidated);
}
TEST_F(Planted, pageable_memory_in_a_capture_is_refused) {
    const TwoStreams s;
    const Array<int> memory(4);
    int pageable[4] = {};
    check(cudaStreamBeginCapture(s.first, cudaStreamCaptureModeThreadLocal));
    EXPECT_EQ(cudaMemcpyAsync(pageable, memory.data(), 16, cudaMemcpyDeviceToHost, s.first),
              cudaErrorStreamCaptureUnsupported);
    cudaGraph_t graph;
    EXPECT_EQ(cudaStreamEndCapture(s.first, &graph), cudaErrorStreamCaptureInvalidated);
}

}  // namespace
