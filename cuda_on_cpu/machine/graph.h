#pragma once

// Graphs: what a capture records, and what a launch runs. A node runs after those it names; among nodes that are ready
// the order (settings.h) chooses, so a dependency that was forgotten shows.

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_types.h"

namespace cuda_on_cpu {

/// One thing for a stream to do.
struct Work {
    enum class Kind { kernel, copy, set, host, graph };
    Kind kind;
    const void* function = nullptr;  ///< of a kernel
    std::function<void()> run;
};

struct Node {
    Work work;
    std::vector<std::size_t> after;  ///< indices of nodes that come before, in ascending order
};
using Nodes = std::vector<Node>;

/// Runs all nodes, each after those it names.
void run_nodes(const Nodes& nodes);

/// The most nodes of which each waits for the one before.
std::size_t longest_chain(const Nodes& nodes);

/// What has been made of captures so far.
struct GraphCount {
    std::size_t instantiated = 0;
    std::size_t nodes = 0;  ///< of the last one
    std::size_t chain = 0;  ///< of these, the most that wait for each other
};
GraphCount& graph_count();

/// A capture in progress. Streams that an event has brought in are members, too.
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

/// Launched graphs hold the nodes they were launched with: an update changes only what is launched later.
struct CUgraphExec_st {
    std::shared_ptr<const cuda_on_cpu::Nodes> nodes;
};
