#pragma once

// A stream on which tests, in the role of a caller, capture calls into a CUDA graph.

#include <cuda_runtime.h>

#include "crumple/crumple.h"
#include "cuda/device_mesh.h"

namespace crumple::test {

/// Stream, and a graph of the calls that were captured on it.
class Recorder {
   public:
    Recorder() { check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking)); }
    ~Recorder() {
        drop();
        cudaStreamDestroy(stream_);
    }
    MeshView on(MeshView mesh) const {
        mesh.stream = stream_;
        return mesh;
    }
    cudaStream_t stream() const { return stream_; }
    void begin() const { check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal)); }
    void end() {
        cudaGraph_t graph = nullptr;
        check(cudaStreamEndCapture(stream_, &graph));
        drop();  // only now: destroying the old graph during the capture would invalidate the capture
        check(cudaGraphInstantiate(&executable_, graph, 0));
        check(cudaGraphDestroy(graph));
    }
    void replay() const {
        check(cudaGraphLaunch(executable_, stream_));
        check(cudaStreamSynchronize(stream_));
    }

   private:
    void drop() {
        if (executable_) cudaGraphExecDestroy(executable_);
        executable_ = nullptr;
    }
    cudaStream_t stream_ = nullptr;
    cudaGraphExec_t executable_ = nullptr;
};

/// Replays until the result is complete, five times at most. Even for a static scene, one replay may not suffice:
/// cluster centres move from replay to replay, so many triangles may change clusters, and a list of the graph may be
/// too short.
template <class Query>
typename Query::DeviceResult replay_until_complete(const Recorder& recorder, const LaunchTicket<Query>& launched) {
    for (int replay = 0;; ++replay) {
        recorder.replay();
        const typename Query::DeviceResult found = launched.wait();
        if (found.complete || replay == 4) return found;
    }
}

/// Launches twice to grow buffers, captures `launch()`, and replays it until the result is complete. If five replays do
/// not suffice, starts again, up to five captures in all, as the error message of download() advises. A new capture may
/// be needed because the axis of a sweep may depend on the order of the device's threads, and along another axis more
/// boxes overlap than the graph's lists hold.
auto capture_until_complete(Recorder& recorder, auto&& launch) {
    for (int capture = 0;; ++capture) {
        for (int call = 0; call < 2; ++call) launch().wait();
        recorder.begin();
        const auto launched = launch();
        recorder.end();
        const auto found = replay_until_complete(recorder, launched);
        if (found.complete || capture == 4) return found;
    }
}

}  // namespace crumple::test
