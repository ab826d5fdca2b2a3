#pragma once

// Stream captures that callers have begun: finds the capture that a stream takes part in, and makes work of the backend
// part of it. "Our stream" is the backend's own; a side branch is a second stream that forks from it and joins it again
// (Branch).
//
//     caller's stream   ── ... ──┐                        ┌── ...
//     our stream                 └── pass ──┬────── pass ─┘
//     side branch                           └── next ──┘
//
// Once forked, our streams belong to the capture until the caller ends it.

#include "backends/cuda/device/cuda_device.h"

namespace crumple::cuda {

/// Returns the id of the capture that the stream takes part in; 0: none. Throws Error (invalid_argument) if that
/// capture has been invalidated.
unsigned long long capture_of(cudaStream_t stream);

class CallersCapture {
   public:
    /// `own`: our stream. `beside`: the side branch that work on our stream may fork.
    CallersCapture(const Device& device, cudaStream_t own, const Branch& beside)
        : own_(own), beside_(beside), ordering_event_(make_event(device)) {}

    /// Adds the work that enqueue() gives to our stream to the capture of `stream`. If enqueue() throws, joins the
    /// streams all the same, so that the capture can go on unless CUDA has invalidated it.
    template <class Enqueue>
    void add(cudaStream_t stream, Enqueue enqueue) const {
        const CaptureMode strict(cudaStreamCaptureModeThreadLocal);  // allocating or waiting is an error meanwhile
        order(ordering_event_, stream, own_);
        try {
            enqueue();
        } catch (...) {
            lead_back(stream);
            throw;
        }
        order(ordering_event_, own_, stream);
    }

   private:
    void lead_back(cudaStream_t stream) const noexcept;

    cudaStream_t own_;
    const Branch& beside_;
    Event ordering_event_;
};

}  // namespace crumple::cuda
