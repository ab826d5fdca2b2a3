#pragma once

// Cache of CUDA graphs for work that is enqueued again and again. Work of the same shape (Key::shape()) launches the
// same kernels, possibly with other addresses and lengths. How work is enqueued depends on what has been enqueued
// before:
//
//     before                          now
//     nothing of its shape            launch by launch, which also loads the kernels
//     other work of its shape         one graph for all such work, updated with the new addresses and lengths
//     the same work, once             a graph of its own, made now
//     the same work, more often       that graph of its own
//
// "Before" covers the last eight keys, and the shape of the latest work that was enqueued launch by launch.
//
// So arrays that move from frame to frame, and lists that grow, need no new graph; a repeated frame costs one launch;
// and no kernel is loaded during a capture.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "backends/cuda/device/cuda_device.h"

namespace crumple::cuda {

/// Captures the work that enqueue() gives to `stream`, and returns it as a graph.
template <class Enqueue>
Graph capture(cudaStream_t stream, Enqueue enqueue) {
    const CaptureMode strict(cudaStreamCaptureModeThreadLocal);  // allocating or waiting is an error meanwhile
    CRUMPLE_CUDA(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
    cudaGraph_t made = nullptr;
    try {
        enqueue();
    } catch (...) {
        cudaStreamEndCapture(stream, &made);
        const Graph spoilt(made);
        throw;
    }
    CRUMPLE_CUDA(cudaStreamEndCapture(stream, &made));
    return Graph(made);
}

inline GraphExec instantiate(const Graph& graph) {
    cudaGraphExec_t executable = nullptr;
    CRUMPLE_CUDA(cudaGraphInstantiate(&executable, graph.get(), 0));
    return GraphExec(executable);
}

/// Makes the executable run `graph` from its next launch on. Returns false if CUDA cannot update the executable,
/// because the nodes or dependencies of `graph` are others.
inline bool update(const GraphExec& executable, const Graph& graph) {
    cudaGraphExecUpdateResultInfo result{};
    const cudaError_t error = cudaGraphExecUpdate(executable.get(), graph.get(), &result);
    if (error != cudaErrorGraphExecUpdateFailure) CRUMPLE_CUDA(error);
    if (error != cudaSuccess) cudaGetLastError();  // else the next check would report it
    return error == cudaSuccess;
}

/// Reduces an address to what the choice of kernels depends on: whether it is null, and its alignment. For
/// Key::shape().
template <class T>
void forget_place(T*& place) {
    constexpr std::uintptr_t alignment = 16;
    if (place) place = reinterpret_cast<T*>(alignment + reinterpret_cast<std::uintptr_t>(place) % alignment);
}

/// Cached graphs of one kind of work: the graphs of the last eight keys, and one graph for work of the latest shape.
/// `Key`: all that the work depends on. Key::shape(): the key, reduced to what the choice of kernels depends on.
template <class Key>
class GraphCache {
   public:
    GraphCache(const Device& device, cudaStream_t own) : own_(own), ordering_event_(make_event(device)) {}

    /// Enqueues the work on `stream`, in one of the ways above. enqueue() gives the work to our own stream.
    template <class Enqueue>
    void run(const Key& key, cudaStream_t stream, Enqueue enqueue) {
        const auto found =
            std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.met && kept.key == key; });
        const bool met = found != kept_.end();
        // Moves the entry to the front; a new one replaces the last.
        std::rotate(kept_.begin(), met ? found : std::prev(kept_.end()), met ? std::next(found) : kept_.end());
        Kept& kept = kept_[0];
        if (met) {
            if (!kept.graph) kept.graph = instantiate(capture(own_, enqueue));
            CRUMPLE_CUDA(cudaGraphLaunch(kept.graph.get(), stream));
            return;
        }
        kept = {};
        if (moving_.met && moving_.key == key.shape()) {
            const Graph graph = capture(own_, enqueue);
            if (!moving_.graph || !update(moving_.graph, graph)) moving_.graph = instantiate(graph);
            CRUMPLE_CUDA(cudaGraphLaunch(moving_.graph.get(), stream));
        } else {
            run_once(stream, enqueue);
            moving_ = {key.shape(), true, {}};
        }
        kept.key = key;
        kept.met = true;
    }

    /// Enqueues work that will not be repeated, launch by launch.
    template <class Enqueue>
    void run_once(cudaStream_t stream, Enqueue enqueue) const {
        order(ordering_event_, stream, own_);
        enqueue();
        order(ordering_event_, own_, stream);
    }

    void clear() {
        kept_ = {};
        moving_ = {};
    }

   private:
    struct Kept {
        Key key{};
        bool met = false;
        GraphExec graph;
    };

    cudaStream_t own_;
    Event ordering_event_;
    std::array<Kept, 8> kept_;  ///< most recently used first; enough for two slots that alternate between buffers
    Kept moving_;               ///< graph that work of one shape shares; its key is that shape
};

}  // namespace crumple::cuda
