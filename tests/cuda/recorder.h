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

}  // namespace crumple::test
