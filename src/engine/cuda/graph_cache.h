#pragma once

// Work that is given to a stream again and again: launch by launch the first time, which also loads its kernels, and as
// one CUDA graph from the second time on. So a caller
// whose arrays move with each call never pays for a graph, and no kernel is loaded while a stream captures.

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include "engine/cuda/device.h"

namespace crumple::cuda {

/// What `enqueue` gives to `stream`, as a graph.
template <class Enqueue>
GraphExec capture(cudaStream_t stream, Enqueue enqueue) {
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
    const Graph graph(made);
    cudaGraphExec_t executable = nullptr;
    CRUMPLE_CUDA(cudaGraphInstantiate(&executable, graph.get(), 0));
    return GraphExec(executable);
}

/// `Key`: all that the work depends on.
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
        if (!met) {
            kept = {};
            order(turn_, stream, own_);
            enqueue();
            order(turn_, own_, stream);
            kept.key = key;
            kept.met = true;
            return;
        }
        if (!kept.graph) kept.graph = capture(own_, enqueue);
        CRUMPLE_CUDA(cudaGraphLaunch(kept.graph.get(), stream));
    }

    void clear() { kept_ = {}; }

   private:
    struct Kept {
        Key key{};
        bool met = false;
        GraphExec graph;
    };

    cudaStream_t own_;
    Event turn_;
    std::array<Kept, 4> kept_;  ///< for simulations that write their frames to several buffers in turn
};

}  // namespace crumple::cuda
