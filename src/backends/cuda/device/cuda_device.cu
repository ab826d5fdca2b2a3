#include "backends/cuda/device/cuda_device.h"

#include <string>

#include "crumple/device.h"
#include "crumple/error.h"

namespace crumple::cuda {

unsigned block_threads = 256;

namespace {

std::string unavailable(const std::string& reason) { return "the cuda backend is not available: " + reason; }

/// Returns the number of devices. If there are none, sets `reason`.
int count_devices(std::string& reason) {
    int count = 0;  // not written if there is no driver
    const cudaError_t error = cudaGetDeviceCount(&count);
    if (error != cudaSuccess) {
        cudaGetLastError();  // else the next check would report it
        reason = unavailable(cudaGetErrorString(error));
        return 0;
    }
    if (count == 0) reason = unavailable("CUDA finds no device");
    return count;
}

__global__ void do_nothing() {}

}  // namespace

Device::Device(int index) : index_(index) {
    const auto refuse = [](const std::string& reason) {
        throw Error(ErrorCode::backend_unavailable, reason, Element::option);
    };
    std::string reason;
    const int count = count_devices(reason);
    if (count == 0) refuse(reason);
    if (index < 0 || index >= count)
        refuse(unavailable("device " + std::to_string(index) +
                           " does not exist (number of devices: " + std::to_string(count) + ")"));
    const Current current(*this);
    // Fails if this build has no code for the device.
    cudaFuncAttributes attributes;
    const cudaError_t error = cudaFuncGetAttributes(&attributes, do_nothing);
    if (error != cudaSuccess) {
        cudaGetLastError();
        refuse(unavailable("device " + std::to_string(index) + ": " + cudaGetErrorString(error)));
    }
}

Geometry Device::geometry() const {
    int multiprocessors = 0, resident = 0;
    CRUMPLE_CUDA(cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, index_));
    CRUMPLE_CUDA(cudaDeviceGetAttribute(&resident, cudaDevAttrMaxThreadsPerMultiProcessor, index_));
    return {block_threads, static_cast<unsigned>(multiprocessors * resident) / block_threads,
            static_cast<unsigned>(multiprocessors)};
}

Device::Current::Current(const Device& device) {
    // Clears the last error of the caller's thread, for example cudaErrorNotReady. CUB queries the last error when it
    // launches a kernel, and would report the caller's error as its own. The error cannot be restored afterwards
    // (docs/cuda.md).
    cudaGetLastError();
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

void order(const Event& event, cudaStream_t first, cudaStream_t then) {
    CRUMPLE_CUDA(cudaEventRecord(event.get(), first));
    CRUMPLE_CUDA(cudaStreamWaitEvent(then, event.get(), 0));
}

Stream make_stream(const Device& device) {
    const Device::Current current(device);
    cudaStream_t stream;
    CRUMPLE_CUDA(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
    return Stream(stream);
}

StageEvents::StageEvents(const Device& device) {
    const Device::Current current(device);
    for (Event& event : events_) {
        cudaEvent_t fresh;
        CRUMPLE_CUDA(cudaEventCreate(&fresh));
        event = Event(fresh);
    }
}
void StageEvents::begin(Stage stage, cudaStream_t stream) {
    CRUMPLE_CUDA(cudaEventRecord(events_[static_cast<std::size_t>(stage)].get(), stream));
}
void StageEvents::end(cudaStream_t stream) { CRUMPLE_CUDA(cudaEventRecord(events_[stage_count].get(), stream)); }
void StageEvents::read(Statistics& statistics) const {
    for (std::size_t s = 0; s < stage_count; ++s) {
        float milliseconds = 0;
        CRUMPLE_CUDA(cudaEventElapsedTime(&milliseconds, events_[s].get(), events_[s + 1].get()));
        statistics.stage_milliseconds[s] += static_cast<double>(milliseconds);
    }
}

}  // namespace crumple::cuda

namespace crumple {

bool has_cuda_backend() { return true; }

DeviceList list_devices() {
    DeviceList list;
    const int count = cuda::count_devices(list.reason);
    for (int i = 0; i < count; ++i) {
        cudaDeviceProp properties;
        if (const cudaError_t error = cudaGetDeviceProperties(&properties, i); error != cudaSuccess) {
            cudaGetLastError();
            list.reason = cuda::unavailable(cudaGetErrorString(error));
            continue;
        }
        list.devices.push_back({i, properties.name, properties.major, properties.minor,
                                static_cast<std::int64_t>(properties.totalGlobalMem)});
    }
    if (!list.devices.empty()) list.reason.clear();
    return list;
}

}  // namespace crumple
