#pragma once

// Work that is given to a stream again and again, as CUDA graphs. What is made of it depends on how it was met before:
//
//     never, nor any of its shape      launch by launch, which also loads its kernels
//     never, but work of its shape     the one graph for work that moves, which is given the new addresses and lengths
//     once                             a graph of its own from now on
//     more often                       that graph
//
// So arrays that lie elsewhere in each frame, and lists that grow, cost no new graph; frames that come again cost one
// launch; and no kernel is loaded while a stream captures.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "backends/cuda/device/cuda_device.h"

namespace crumple::cuda {

/// What `enqueue` gives to `stream`, as a graph.
template <class Enqueue>
Graph capture(cudaStream_t stream, Enqueue enqueue) {
    const CaptureMode strict(cudaStreamCaptureModeThreadLocal);  // allocating or waiting meanwhile is an error
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

/// Has it do what `graph` does, if that has the same nodes, from its next launch on. False if it has not.
inline bool update(const GraphExec& executable, const Graph& graph) {
    cudaGraphExecUpdateResultInfo result{};
    const cudaError_t error = cudaGraphExecUpdate(executable.get(), graph.get(), &result);
    if (error != cudaErrorGraphExecUpdateFailure) CRUMPLE_CUDA(error);
    if (error != cudaSuccess) cudaGetLastError();  // or the next check would meet it
    return error == cudaSuccess;
}

/// Makes of a caller's address what kernels are chosen by: whether there is an array, and how it is aligned. For
/// Key::shape().
template <class T>
void forget_place(T*& place) {
    constexpr std::uintptr_t alignment = 16;
    if (place) place = reinterpret_cast<T*>(alignment + reinterpret_cast<std::uintptr_t>(place) % alignment);
}

/// `Key`: all that the work depends on. `Key::shape()`: what its kernels depend on, as a key.
template <class Key>
class GraphCache {
   public:
    GraphCache(const Device& device, cudaStream_t own) : own_(own), turn_(make_event(device)) {}

    /// Gives the work to `stream`; `enqueue` gives it to our own.
    template <class Enqueue>
    void run(const Key& key, cudaStream_t stream, Enqueue enqueue) {
        const auto found =
            std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.met && kept.key == key; });
        const bool met = found != kept_.end();
        // The latest comes first, and the last one goes.
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

    /// The same for work that will not come again: launch by launch.
    template <class Enqueue>
    void run_once(cudaStream_t stream, Enqueue enqueue) const {
        order(turn_, stream, own_);
        enqueue();
        order(turn_, own_, stream);
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
    Event turn_;
    std::array<Kept, 8> kept_;  ///< for two slots, and simulations that write their frames to several buffers in turn
    Kept moving_;               ///< by shape
};

}  // namespace crumple::cuda
