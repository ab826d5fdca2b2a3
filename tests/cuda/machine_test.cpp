// Tests that need an emulated device (a machine whose settings can be changed): no device, no driver, failing
// allocations and launches, counts of graph nodes.

#include <gtest/gtest.h>

#include "agreement/compare.h"
#include "backends/cuda/stages/plan.h"
#include "crumple/error.h"
#include "cuda/device_mesh.h"
#include "cuda/downloaded_results.h"
#include "cuda_on_cpu/machine/graph.h"
#include "cuda_on_cpu/machine/memory.h"
#include "cuda_on_cpu/machine/sanitizers.h"
#include "cuda_on_cpu/machine/settings.h"
#include "scenes/scenes.h"
#include "soups.h"

#ifdef CUDA_ON_CPU_ASAN
#include <sanitizer/lsan_interface.h>
#endif

namespace crumple::test {
namespace {

using cuda_on_cpu::settings;

class CudaMachine : public testing::Test {
   protected:
    void TearDown() override {
        settings() = {};
        settings().multiprocessors = 1;
    }
    static std::string message() {
        try {
            Detector({.backend = Backend::cuda});
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
            return std::string(error.what()).substr(0, 37);
        }
        return "no error";
    }
};

TEST_F(CudaMachine, missing_device_makes_the_backend_unavailable) {
    settings().devices = 0;
    EXPECT_EQ(message(), "the cuda backend is not available: no");  // the rest is CUDA's message
}

TEST_F(CudaMachine, missing_driver_makes_the_backend_unavailable) {
    settings().driver = false;
    EXPECT_EQ(message().substr(0, 34), "the cuda backend is not available:");
}

TEST_F(CudaMachine, device_number_that_does_not_exist_is_an_error) {
    try {
        Detector({.backend = Backend::cuda, .device = 3});
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "the cuda backend is not available: device 3 does not exist (number of devices: 1)");
    }
}

TEST_F(CudaMachine, list_devices_gives_devices_or_a_reason) {
    settings().devices = 2;
    const DeviceList two = list_devices();
    ASSERT_EQ(two.devices.size(), 2u);
    EXPECT_EQ(two.reason, "");
    EXPECT_EQ(two.devices[1].number, 1);
    EXPECT_NE(two.devices[1].name, "");
    EXPECT_GE(two.devices[1].major, 7);
    EXPECT_EQ(two.devices[1].memory_bytes, static_cast<std::int64_t>(settings().device_bytes));
    settings().devices = 0;
    EXPECT_TRUE(list_devices().devices.empty());
    EXPECT_TRUE(list_devices().reason.starts_with("the cuda backend is not available: ")) << list_devices().reason;
    settings().devices = 1;
    settings().driver = false;
    EXPECT_TRUE(list_devices().devices.empty());
    EXPECT_TRUE(list_devices().reason.starts_with("the cuda backend is not available: ")) << list_devices().reason;
}

TEST_F(CudaMachine, automatic_backend_uses_a_device_if_there_is_one) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 100, .frame = 40});
    const auto chosen = [&](const Options& options) {
        Detector detector(options);
        const std::string backend(detector.find(mesh.view()).statistics.backend);
        return backend + (detector.fallback().empty() ? "" : ": " + std::string(detector.fallback()));
    };
    EXPECT_EQ(chosen({}), "cuda");
    EXPECT_EQ(chosen({.backend = Backend::cpu}), "cpu");
    EXPECT_EQ(chosen({.device = 1}),
              "cpu: the cuda backend is not available: device 1 does not exist (number of devices: 1)");
    settings().devices = 0;
    EXPECT_EQ(chosen({}).substr(0, 40), "cpu: the cuda backend is not available: ");
}

TEST_F(CudaMachine, failed_allocation_gives_result_or_device_error) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 300, .frame = 93});
    for (const IntersectionQuery& query : {IntersectionQuery{}, {.output = Output::contacts}}) {
        const Intersections expected = Detector({.backend = Backend::cpu}).find(mesh.view(), query);
        int failures = 0;
        for (int allocations = 0; allocations < 14; ++allocations) {
            Detector detector({.backend = Backend::cuda});
            settings().allocations_before_failure = allocations;
            try {
                EXPECT_TRUE(same_result(detector.find(mesh.view(), query), expected));
            } catch (const Error& error) {
                ++failures;
                EXPECT_EQ(error.code, ErrorCode::device) << error.what();
            }
            settings().allocations_before_failure = -1;
            EXPECT_TRUE(same_result(detector.find(mesh.view(), query), expected)) << "after " << allocations;
        }
        EXPECT_LT(failures, 8);
    }
}

TEST_F(CudaMachine, repeated_launches_reuse_graphs) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 300, .frame = 93});
    Detector cuda({.backend = Backend::cuda});
    const auto frames = [&](const DeviceMesh& device, int count) {
        const std::size_t before = cuda_on_cpu::graph_count().instantiated;
        for (int frame = 0; frame < count; ++frame) EXPECT_GT(cuda.launch(device.view()).wait().count, 0);
        return cuda_on_cpu::graph_count().instantiated - before;
    };
    std::vector<DeviceMesh> buffers;
    for (int i = 0; i < 6; ++i) buffers.emplace_back(mesh.view());
    EXPECT_EQ(frames(buffers[0], 2), 0u) << "without centres and with";
    EXPECT_EQ(frames(buffers[0], 1), 1u) << "the one that moves, for the other slot";
    EXPECT_EQ(frames(buffers[0], 2), 2u) << "one a slot";
    EXPECT_EQ(frames(buffers[0], 5), 0u);
    std::size_t made = 0;
    for (int turn = 0; turn < 12; ++turn) made += frames(buffers[static_cast<std::size_t>(turn % 4)], 1);
    EXPECT_EQ(made, 3u) << "four buffers in turn, one of which is known";
    made = 0;
    for (int turn = 0; turn < 40; ++turn) made += frames(buffers[static_cast<std::size_t>(turn % 5)], 1);
    EXPECT_EQ(made, 0u) << "five in two slots are more than are kept";
}

// One graph is updated with the addresses of each frame. The arrays of all frames stay allocated, so that no address
// occurs twice.
TEST_F(CudaMachine, one_graph_serves_changing_addresses_and_growing_results) {
    constexpr int n = 1500;
    const Soup<float> soups[] = {random_soup(n, 1e-3), random_soup(n, 0.5, 2), random_soup(n, 0.8, 3)};
    Detector cpu({.backend = Backend::cpu}), cuda({.backend = Backend::cuda});
    std::vector<Intersections> expected;
    for (const Soup<float>& soup : soups) expected.push_back(cpu.find(soup.view()));
    ASSERT_GT(expected[1].pairs.size(), 2u * n);
    ASSERT_GT(expected[2].pairs.size(), expected[1].pairs.size() * 5 / 4);
    const std::size_t before = cuda_on_cpu::graph_count().instantiated;
    std::vector<DeviceMesh> frames;
    const auto soup_of = [](std::size_t frame) { return frame < 6 ? 0u : frame < 12 ? 1u : 2u; };
    std::vector<LaunchTicket<IntersectionQuery>> launched;
    const auto expect_right = [&](std::size_t frame) {
        EXPECT_TRUE(shows(launched[frame].wait(), soups[0].view(), nullptr, expected[soup_of(frame)]))
            << "frame " << frame;
    };
    for (std::size_t frame = 0; frame < 18; ++frame) {
        frames.emplace_back(soups[soup_of(frame)].view());
        launched.push_back(cuda.launch(frames.back().view()));
        if (frame > 0) expect_right(frame - 1);
    }
    expect_right(17);
    EXPECT_EQ(cuda_on_cpu::graph_count().instantiated - before, 1u);
    EXPECT_EQ(cuda_on_cpu::graph_count().chain, 14u);
}

TEST_F(CudaMachine, chunk_lists_grow_with_the_available_memory) {
    cuda::Plan plan;
    const auto survivors = [&](std::int64_t bytes) {
        plan.choose_chunks(100'000, false, {}, bytes);
        return plan.survivors;
    };
    EXPECT_EQ(survivors(0), 1024u) << "what a unit may have";
    EXPECT_EQ(survivors(24'000'000), 401'024u) << "what a pass at once would have";
    EXPECT_EQ(survivors(2'400'000), 100'000u);
}

// Checks the number of nodes on the longest chain of dependencies, each of which takes time; benchmarks/least_work.cpp
// uses these numbers. The other nodes prepare the warm start of the next frame beside the chain: two iterations of two
// nodes and positions for each level, and the frames of leaves. The order in which threads add affects the clusters;
// the scene has so few triangles that this does not change the number of levels.
TEST_F(CudaMachine, graph_of_a_launch_has_at_most_15_nodes_on_its_longest_chain) {
    const io::TriangleMesh mesh = scenes::make("soup", {.triangles = 50});
    ASSERT_EQ(mesh.view().triangles.rows, 50);
    const DeviceMesh device(mesh.view());
    struct Case {
        int clusters, leaf_size;
        std::size_t chain, nodes;
    };
    for (const auto& [clusters, leaf_size, chain, nodes] :
         {Case{1, 3000, 14, 16}, {3, 3000, 14, 20}, {2, 15, 15, 26}}) {
        Detector cuda({.backend = Backend::cuda, .clusters = clusters, .leaf_size = leaf_size});
        for (int frame = 0; frame < 5; ++frame) cuda.launch(device.view()).wait();
        EXPECT_EQ(cuda_on_cpu::graph_count().chain, chain) << "leaves of " << leaf_size;
        EXPECT_EQ(cuda_on_cpu::graph_count().nodes, nodes) << "leaves of " << leaf_size;
    }
}

// A caller's graph gets the same nodes as a graph of the library, and needs no allocation.
TEST_F(CudaMachine, callers_graph_has_20_nodes_and_needs_no_allocation) {
    const DeviceMesh device(scenes::make("soup", {.triangles = 50}).view());
    Detector cuda({.backend = Backend::cuda, .clusters = 3});
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    MeshView view = device.view();
    view.stream = stream;
    for (int call = 0; call < 2; ++call) cuda.launch(view).wait();
    const std::size_t used = cuda_on_cpu::memory::used(), graphs = cuda_on_cpu::graph_count().instantiated;
    settings().allocations_before_failure = 0;
    check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
    const auto launched = cuda.launch(view);
    cudaGraph_t graph = nullptr;
    check(cudaStreamEndCapture(stream, &graph));
    EXPECT_EQ(cuda_on_cpu::memory::used(), used);
    EXPECT_EQ(cuda_on_cpu::graph_count().instantiated, graphs);
    cudaGraphExec_t executable = nullptr;
    check(cudaGraphInstantiate(&executable, graph, 0));
    EXPECT_EQ(cuda_on_cpu::graph_count().chain, 14u);
    EXPECT_EQ(cuda_on_cpu::graph_count().nodes, 20u);
    check(cudaGraphLaunch(executable, stream));
    check(cudaStreamSynchronize(stream));
    EXPECT_TRUE(launched.wait().complete) << "and wait() allocates nothing, either";
    check(cudaGraphExecDestroy(executable));
    check(cudaGraphDestroy(graph));
    check(cudaStreamDestroy(stream));
}

// wait() needs memory for the contacts of a replay. If there is none, it must not free lists, which the caller's graph
// uses.
TEST_F(CudaMachine, missing_memory_for_contacts_of_a_replay_is_an_error) {
    const io::TriangleMesh few = scenes::make("cloth", {.triangles = 300, .frame = 80}),
                           many = scenes::make("cloth", {.triangles = 300, .frame = 93});
    DeviceMesh device(few.view());
    const IntersectionQuery query{.output = Output::contacts};
    Detector cuda({.backend = Backend::cuda});
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    MeshView view = device.view();
    view.stream = stream;
    for (int call = 0; call < 2; ++call) cuda.launch(view, query).wait();
    check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
    const auto launched = cuda.launch(view, query);
    cudaGraph_t graph = nullptr;
    check(cudaStreamEndCapture(stream, &graph));
    cudaGraphExec_t executable = nullptr;
    check(cudaGraphInstantiate(&executable, graph, 0));
    device.set_vertices(many.view());
    check(cudaGraphLaunch(executable, stream));
    check(cudaStreamSynchronize(stream));
    settings().allocations_before_failure = 0;
    try {
        EXPECT_FALSE(launched.wait().complete) << "no contacts were made";
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::device) << error.what();
    }
    settings().allocations_before_failure = -1;
    EXPECT_THROW(launched.wait(), Error) << "the launch is over";
    EXPECT_GT(cuda.launch(view, query).wait().contact_point_count, 0);
    check(cudaGraphExecDestroy(executable));
    check(cudaGraphDestroy(graph));
    check(cudaStreamDestroy(stream));
}

// A launch that fails within a capture joins the streams that it has forked, so that the caller can end the capture.
TEST_F(CudaMachine, failed_launch_leaves_the_capture_valid) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 300, .frame = 93});
    const DeviceMesh device(mesh.view());
    cudaStream_t stream;
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    MeshView view = device.view();
    view.stream = stream;
    for (int launches = 0; launches < 16; launches += 3) {
        SCOPED_TRACE(testing::Message() << "after " << launches);
        Detector cuda({.backend = Backend::cuda});
        for (int call = 0; call < 2; ++call) cuda.launch(view).wait();
        const std::int64_t pairs = cuda.find(view).statistics.pairs;
        check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
        settings().launches_before_failure = launches;
        EXPECT_THROW(cuda.launch(view), Error);
        settings().launches_before_failure = -1;
        cudaGraph_t graph = nullptr;
        EXPECT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
        if (graph) check(cudaGraphDestroy(graph));
        EXPECT_EQ(cuda.launch(view).wait().count, pairs);
    }
    check(cudaStreamDestroy(stream));
}

// A kernel launch may fail because the driver finds no memory for stacks or graphs.
TEST_F(CudaMachine, failed_kernel_launch_does_not_change_result) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 300, .frame = 93});
    const DeviceMesh device(mesh.view());
    const IntersectionQuery query{.output = Output::contacts};
    const Intersections expected = Detector({.backend = Backend::cpu}).find(mesh.view(), query);
    for (int launches = 0; launches < 40; launches += 3) {
        SCOPED_TRACE(testing::Message() << "after " << launches);
        Detector first({.backend = Backend::cuda}), second({.backend = Backend::cuda});
        settings().launches_before_failure = launches;
        EXPECT_TRUE(same_result(first.find(mesh.view(), query), expected));
        settings().launches_before_failure = launches;
        EXPECT_TRUE(shows(second.launch(device.view(), query).wait(), mesh.view(), nullptr, expected));
        settings().launches_before_failure = -1;
    }
}

TEST_F(CudaMachine, missing_memory_for_stacks_makes_the_backend_unavailable) {
    settings().launches_before_failure = 0;
    const std::string reason =
        "the cuda backend is not available: device 0 has no memory left for it (cudaLaunchKernelEx: out of memory)";
    try {
        Detector({.backend = Backend::cuda});
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
        EXPECT_EQ(error.what(), reason);
    }
    settings().launches_before_failure = 0;
    EXPECT_EQ(Detector().fallback(), reason);
}

TEST_F(CudaMachine, arrays_that_the_device_cannot_read_are_rejected) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 100, .frame = 40});
    Detector cuda({.backend = Backend::cuda});
    const auto message = [&](auto call) -> std::string {
        try {
            call();
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::invalid_argument);
            return error.what();
        }
        return "no error";
    };
    const DeviceMesh device(mesh.view());
    MeshView wrong = device.view();
    wrong.vertices = mesh.view().vertices;
    for (int repeat = 0; repeat < 2; ++repeat)
        EXPECT_EQ(message([&] { cuda.find(wrong); }), "vertices lie in host memory, which CUDA device 0 cannot read");
    EXPECT_EQ(message([&] {
                  cuda.launch({device.view(), wrong});
              }),
              "vertices of the second mesh lie in host memory, which CUDA device 0 cannot read");
    wrong = device.view();
    wrong.triangles = mesh.view().triangles;
    EXPECT_EQ(message([&] { cuda.any(wrong); }), "triangles lie in host memory, which CUDA device 0 cannot read");
    settings().devices = 2;
    check(cudaSetDevice(1));
    const DeviceMesh other(mesh.view());
    check(cudaSetDevice(0));
    EXPECT_EQ(message([&] { cuda.partition(other.view(), {}, 2); }),
              "vertices lie in the memory of CUDA device 1, which CUDA device 0 cannot read");
    EXPECT_EQ(message([&] { cuda.find(device.view()); }), "no error");
}

TEST_F(CudaMachine, wait_find_and_launch_on_a_broken_device_are_errors) {
#ifdef CUDA_ON_CPU_ASAN
    const __lsan::ScopedDisabler nothing_is_freed_on_a_broken_device;
#endif
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 100, .frame = 40});
    const DeviceMesh device(mesh.view());
    Detector cuda({.backend = Backend::cuda});
    const auto code = [](auto call) {
        try {
            call();
        } catch (const Error& error) {
            return error.code;
        }
        return ErrorCode::cancelled;
    };
    const auto launched = cuda.launch(device.view()), newer = cuda.launch(device.view());
    settings().broken = cudaErrorIllegalAddress;
    EXPECT_EQ(code([&] { launched.wait(); }), ErrorCode::device);
    EXPECT_EQ(code([&] { launched.wait(); }), ErrorCode::invalid_argument) << "the launch is forgotten";
    EXPECT_EQ(code([&] { newer.wait(); }), ErrorCode::invalid_argument) << "so is the other";
    EXPECT_EQ(code([&] { cuda.find(mesh.view()); }), ErrorCode::device);
    EXPECT_EQ(code([&] { cuda.launch(device.view()); }), ErrorCode::device);
}

// If a memory limit suffices, a device with that much free memory and no limit also suffices.
TEST_F(CudaMachine, limit_that_suffices_also_suffices_as_device_memory) {
    const io::TriangleMesh mesh = scenes::make("cloth", {.triangles = 600, .frame = 93});
    const IntersectionQuery query{.output = Output::contacts};
    const Intersections expected = Detector({.backend = Backend::cpu}).find(mesh.view(), query);
    const auto most = Detector({.backend = Backend::cuda}).find(mesh.view(), query).statistics.peak_memory_bytes;
    int successes = 0, failures = 0;
    for (std::int64_t bytes = most; bytes > 10'000; bytes -= bytes / 5) {
        SCOPED_TRACE(testing::Message() << bytes << " bytes");
        const auto gives_result = [&](const Options& options) {
            try {
                Detector detector(options);
                EXPECT_TRUE(same_result(detector.find(mesh.view(), query), expected));
                return true;
            } catch (const Error& error) {
                EXPECT_EQ(error.code, options.memory_limit ? ErrorCode::memory_limit : ErrorCode::device);
                return false;
            }
        };
        const bool within_limit = gives_result({.backend = Backend::cuda, .memory_limit = bytes});
        settings().device_bytes = cuda_on_cpu::memory::used() + static_cast<std::size_t>(bytes);
        const bool within_device = gives_result({.backend = Backend::cuda});
        settings().device_bytes = std::size_t{1} << 30;
        EXPECT_GE(within_device, within_limit);
        ++(within_device ? successes : failures);
    }
    EXPECT_GT(successes, 2);
    EXPECT_GT(failures, 2);
}

}  // namespace
}  // namespace crumple::test
