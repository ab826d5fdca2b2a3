#include "backends/cuda/device/runtime.h"

#include <string>

#include "crumple/error.h"

namespace crumple::cuda {

std::string OutOfDeviceMemory::message() const {
    return call + ": " + (bytes ? std::to_string(bytes) + " bytes: " : "") + "out of memory";
}

void check(cudaError_t error, const char* call) {
    if (error == cudaSuccess) return;
    cudaGetLastError();  // else the next check would report it again
    const std::string text = std::string(call).substr(0, std::string(call).find('('));
    if (error == cudaErrorMemoryAllocation) throw OutOfDeviceMemory{text};
    throw Error(ErrorCode::device, text + ": " + cudaGetErrorString(error) + " (" + cudaGetErrorName(error) + ")");
}

}  // namespace crumple::cuda
