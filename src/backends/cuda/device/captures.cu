#include "backends/cuda/device/captures.h"

#include "crumple/error.h"

namespace crumple::cuda {

unsigned long long capture_of(cudaStream_t stream) {
    // The legacy stream cannot be captured, and CUDA refuses the query while a blocking stream captures.
    if (!stream || stream == cudaStreamLegacy) return 0;
    cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
    unsigned long long id = 0;
    CRUMPLE_CUDA(cudaStreamGetCaptureInfo(stream, &status, &id));
    if (status == cudaStreamCaptureStatusInvalidated)
        throw Error(ErrorCode::invalid_argument,
                    "the stream's capture has failed before this call; end it, and begin a new one");
    return status == cudaStreamCaptureStatusActive ? id : 0;
}

// Joins the side branch to our stream, and our stream to `stream`, after an error. A fork that is not joined would make
// the capture fail when the caller ends it.
void CallersCapture::lead_back(cudaStream_t stream) const noexcept {
    try {
        if (capture_of(beside_.stream()) != 0) beside_.join(own_);
        order(ordering_event_, own_, stream);
    } catch (...) {  // the capture is invalid, which the caller will notice
    }
}

}  // namespace crumple::cuda
