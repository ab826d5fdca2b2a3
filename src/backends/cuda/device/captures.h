#pragma once

// Captures that callers have begun: which one a stream takes part in, and work of ours that becomes part of it.
//
//     caller's stream   ── ... ──┐                        ┌── ...
//     our stream                 └── pass ──┬────── pass ─┘
//     the one beside                        └── guide ─┘
//
// From its fork on, a stream of ours belongs to the capture until the caller ends that.

#include "backends/cuda/device/cuda_device.h"

namespace crumple::cuda {

/// The number of the capture that the stream takes part in; 0: of none. Throws Error (invalid_argument) if something
/// has spoilt that capture.
unsigned long long capture_of(cudaStream_t stream);

class CallersCapture {
   public:
    /// `beside`: a branch that work on `own` may have forked.
    CallersCapture(const Device& device, cudaStream_t own, const Branch& beside)
        : own_(own), beside_(beside), turn_(make_event(device)) {}

    /// Puts what enqueue() gives to our stream into the capture of `stream`, which it leaves fit to go on, if CUDA
    /// does, whatever enqueue() throws.
    template <class Enqueue>
    void add(cudaStream_t stream, Enqueue enqueue) const {
        const CaptureMode strict(cudaStreamCaptureModeThreadLocal);  // allocating or waiting meanwhile is an error
        order(turn_, stream, own_);
        try {
            enqueue();
        } catch (...) {
            lead_back(stream);
            throw;
        }
        order(turn_, own_, stream);
    }

   private:
    void lead_back(cudaStream_t stream) const noexcept;

    cudaStream_t own_;
    const Branch& beside_;
    Event turn_;
};

}  // namespace crumple::cuda
