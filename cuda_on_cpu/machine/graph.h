#pragma once

// Graphs, which captures record and launches run. A node runs after those that it depends on. Among ready nodes `Order`
// (settings.h) chooses, which exposes missing dependencies.

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_types.h"

namespace cuda_on_cpu {

/// Unit of work of a stream, which is a node if a capture records it.
struct Work {
    enum class Kind { kernel, copy, set, host, graph };
    Kind kind;
    const void* function = nullptr;  ///< identifies the kernel or device-wide primitive
    std::function<void()> run;
};

struct Node {
    Work work;
    std::vector<std::size_t> after;  ///< indices of the nodes that it depends on, ascending
};
using Nodes = std::vector<Node>;

/// Runs all nodes, each after those that it depends on.
void run_nodes(const Nodes& nodes);

/// Returns the number of nodes on the longest path of dependencies.
std::size_t longest_chain(const Nodes& nodes);

/// Counters of executable graphs, for tests.
struct GraphCount {
    std::size_t instantiated = 0;
    std::size_t nodes = 0;  ///< nodes of the last one
    std::size_t chain = 0;  ///< nodes on its longest path of dependencies
};
GraphCount& graph_count();

/// Capture in progress. Its members are the stream where it began and those that joined it by waiting for an event.
struct Capture {
    Nodes nodes;
    CUstream_st* origin = nullptr;
    cudaStreamCaptureMode mode = cudaStreamCaptureModeGlobal;
    std::thread::id thread;
    bool invalid = false;
    unsigned long long id = 0;
    std::set<CUstream_st*> members;
};

}  // namespace cuda_on_cpu

struct CUgraph_st {
    cuda_on_cpu::Nodes nodes;
};

/// Executable graph. A launch holds the nodes that it was enqueued with: an update affects later launches only.
struct CUgraphExec_st {
    std::shared_ptr<const cuda_on_cpu::Nodes> nodes;
};
