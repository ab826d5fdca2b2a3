#include "cuda/device.h"

#include <string>

#include "crumple/error.h"

namespace crumple::cuda {

unsigned block_threads = 256;

Device::Device(int index) : index_(index) {
    // Without a driver the count is left unwritten.
    int count = 0;
    const cudaError_t error = cudaGetDeviceCount(&count);
    const auto unavailable = [](const std::string& reason) {
        throw Error(ErrorCode::backend_unavailable, "the cuda backend is not available: " + reason, Element::option);
    };
    if (error != cudaSuccess) {
        cudaGetLastError();
        unavailable(cudaGetErrorString(error));
    }
    if (index < 0 || index >= count)
        unavailable("device " + std::to_string(index) + " of " + std::to_string(count) + " does not exist");
    const Current current(*this);
    CRUMPLE_CUDA(cudaPeekAtLastError());
}

Geometry Device::geometry() const {
    int multiprocessors = 0, resident = 0;
    CRUMPLE_CUDA(cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, index_));
    CRUMPLE_CUDA(cudaDeviceGetAttribute(&resident, cudaDevAttrMaxThreadsPerMultiProcessor, index_));
    return {block_threads, static_cast<unsigned>(multiprocessors * resident) / block_threads};
}

Device::Current::Current(const Device& device) {
    CRUMPLE_CUDA(cudaGetDevice(&before_));
    if (before_ == device.index_) return;
    CRUMPLE_CUDA(cudaSetDevice(device.index_));
    switched_ = true;
}
Device::Current::~Current() {
    if (switched_) cudaSetDevice(before_);
}

Event make_event(const Device& device) {
    const Device::Current current(device);
    cudaEvent_t event;
    CRUMPLE_CUDA(cudaEventCreateWithFlags(&event, cudaEventDisableTiming));
    return Event(event);
}

Stream make_stream(const Device& device) {
    const Device::Current current(device);
    cudaStream_t stream;
    CRUMPLE_CUDA(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    return Stream(stream);
}

Stopwatch::Stopwatch(const Device& device) {
    const Device::Current current(device);
    for (Event& event : events_) {
        cudaEvent_t fresh;
        CRUMPLE_CUDA(cudaEventCreate(&fresh));
        event = Event(fresh);
    }
}
void Stopwatch::begin(Stage stage, cudaStream_t stream) {
    CRUMPLE_CUDA(cudaEventRecord(events_[static_cast<std::size_t>(stage)].get(), stream));
}
void Stopwatch::end(cudaStream_t stream) { CRUMPLE_CUDA(cudaEventRecord(events_[stage_count].get(), stream)); }
void Stopwatch::read(Statistics& statistics) const {
    for (std::size_t s = 0; s < stage_count; ++s) {
        float milliseconds = 0;
        CRUMPLE_CUDA(cudaEventElapsedTime(&milliseconds, events_[s].get(), events_[s + 1].get()));
        statistics.stage_milliseconds[s] += static_cast<double>(milliseconds);
    }
}

}  // namespace crumple::cuda
