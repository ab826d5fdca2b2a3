// Runtime API: devices and errors.

#include <algorithm>
#include <cstdio>
#include <utility>

#include "cuda_on_cpu/machine/call.h"
#include "cuda_on_cpu/machine/device_limits.h"
#include "cuda_on_cpu/machine/memory.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_api.h"

using namespace cuda_on_cpu;

namespace cuda_on_cpu {

HostThread& host_thread() {
    thread_local HostThread instance;
    return instance;
}

}  // namespace cuda_on_cpu

namespace {

constexpr int l2_bytes = 32 << 20;
constexpr int version = 13000;
constexpr int major = 9, minor = 0;

bool present(int device) { return device >= 0 && device < settings().devices; }

cudaError_t attribute(cudaDeviceAttr which, int& value) {
    switch (which) {
        case cudaDevAttrMaxThreadsPerBlock:
            value = limits::threads_per_block;
            break;
        case cudaDevAttrMaxBlockDimX:
            value = limits::block_x;
            break;
        case cudaDevAttrMaxBlockDimY:
            value = limits::block_y;
            break;
        case cudaDevAttrMaxBlockDimZ:
            value = limits::block_z;
            break;
        case cudaDevAttrMaxGridDimX:
            value = limits::grid_x;
            break;
        case cudaDevAttrMaxGridDimY:
            value = limits::grid_y;
            break;
        case cudaDevAttrMaxGridDimZ:
            value = limits::grid_z;
            break;
        case cudaDevAttrMaxSharedMemoryPerBlock:
            value = static_cast<int>(limits::shared_bytes_per_block);
            break;
        case cudaDevAttrWarpSize:
            value = 32;
            break;
        case cudaDevAttrMaxRegistersPerBlock:
            value = limits::registers;
            break;
        case cudaDevAttrMultiProcessorCount:
            value = settings().multiprocessors;
            break;
        case cudaDevAttrIntegrated:
            value = 0;
            break;
        case cudaDevAttrConcurrentKernels:
            value = 1;
            break;
        case cudaDevAttrL2CacheSize:
            value = l2_bytes;
            break;
        case cudaDevAttrMaxThreadsPerMultiProcessor:
            value = limits::threads_per_multiprocessor;
            break;
        case cudaDevAttrUnifiedAddressing:
            value = 1;
            break;
        case cudaDevAttrComputeCapabilityMajor:
            value = major;
            break;
        case cudaDevAttrComputeCapabilityMinor:
            value = minor;
            break;
        case cudaDevAttrMaxSharedMemoryPerMultiprocessor:
            value = static_cast<int>(limits::shared_bytes_per_multiprocessor);
            break;
        case cudaDevAttrMaxRegistersPerMultiprocessor:
            value = limits::registers;
            break;
        case cudaDevAttrManagedMemory:
            value = 1;
            break;
        case cudaDevAttrPageableMemoryAccess:
            value = 0;
            break;
        case cudaDevAttrCooperativeLaunch:
            value = 0;
            break;
        case cudaDevAttrMaxSharedMemoryPerBlockOptin:
            value = static_cast<int>(limits::shared_bytes_per_block_optin);
            break;
        case cudaDevAttrMaxBlocksPerMultiprocessor:
            value = limits::blocks_per_multiprocessor;
            break;
        case cudaDevAttrReservedSharedMemoryPerBlock:
            value = 1024;
            break;
        case cudaDevAttrMemoryPoolsSupported:
            value = 1;
            break;
        default:
            return cudaErrorInvalidValue;
    }
    return cudaSuccess;
}

}  // namespace

const char* cudaGetErrorName(cudaError_t error) {
    switch (error) {
#define CUDA_ON_CPU_NAME(name, value, text) \
    case name:                              \
        return #name;
        CUDA_ON_CPU_ERRORS(CUDA_ON_CPU_NAME)
    }
    return "unrecognised error code";
}

const char* cudaGetErrorString(cudaError_t error) {
    switch (error) {
#define CUDA_ON_CPU_TEXT(name, value, text) \
    case name:                              \
        return text;
        CUDA_ON_CPU_ERRORS(CUDA_ON_CPU_TEXT)
    }
    return "unrecognised error code";
}

// Without a driver CUDA's runtime always returns cudaErrorInsufficientDriver.
cudaError_t cudaGetLastError() {
    const cudaError_t error = std::exchange(host_thread().last_error, settings().broken);
    return settings().driver ? error : cudaErrorInsufficientDriver;
}
cudaError_t cudaPeekAtLastError() { return settings().driver ? host_thread().last_error : cudaErrorInsufficientDriver; }

cudaError_t cudaGetDeviceCount(int* count) {
    if (!count) return keep(cudaErrorInvalidValue);
    if (!settings().driver) return keep(cudaErrorInsufficientDriver);
    *count = std::max(0, settings().devices);
    return keep(device_missing());
}

cudaError_t cudaSetDevice(int device) {
    return call([&] {
        if (!present(device)) return cudaErrorInvalidDevice;
        host_thread().device = device;
        return cudaSuccess;
    });
}

cudaError_t cudaGetDevice(int* device) {
    return call([&] {
        if (!device) return cudaErrorInvalidValue;
        *device = host_thread().device;
        return cudaSuccess;
    });
}

cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int device) {
    return call([&] {
        if (!properties) return cudaErrorInvalidValue;
        if (!present(device)) return cudaErrorInvalidDevice;
        cudaDeviceProp p{};
        std::snprintf(p.name, sizeof p.name, "CUDA on CPU");
        p.totalGlobalMem = settings().device_bytes;
        p.sharedMemPerBlock = limits::shared_bytes_per_block;
        p.regsPerBlock = p.regsPerMultiprocessor = limits::registers;
        p.warpSize = 32;
        p.maxThreadsPerBlock = limits::threads_per_block;
        p.maxThreadsDim[0] = limits::block_x;
        p.maxThreadsDim[1] = limits::block_y;
        p.maxThreadsDim[2] = limits::block_z;
        p.maxGridSize[0] = limits::grid_x;
        p.maxGridSize[1] = limits::grid_y;
        p.maxGridSize[2] = limits::grid_z;
        p.totalConstMem = 64 << 10;
        p.major = major;
        p.minor = minor;
        p.multiProcessorCount = settings().multiprocessors;
        p.canMapHostMemory = p.concurrentKernels = p.unifiedAddressing = p.managedMemory = p.memoryPoolsSupported = 1;
        p.asyncEngineCount = 1;
        p.pciBusID = device;
        p.memoryBusWidth = 64;
        p.l2CacheSize = l2_bytes;
        p.maxThreadsPerMultiProcessor = limits::threads_per_multiprocessor;
        p.sharedMemPerMultiprocessor = limits::shared_bytes_per_multiprocessor;
        p.sharedMemPerBlockOptin = limits::shared_bytes_per_block_optin;
        p.maxBlocksPerMultiProcessor = limits::blocks_per_multiprocessor;
        p.reservedSharedMemPerBlock = 1024;
        *properties = p;
        return cudaSuccess;
    });
}

cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr which, int device) {
    return call([&] {
        if (!value) return cudaErrorInvalidValue;
        return present(device) ? attribute(which, *value) : cudaErrorInvalidDevice;
    });
}

cudaError_t cudaDeviceGetStreamPriorityRange(int* least, int* greatest) {
    return call([&] {
        if (least) *least = 0;
        if (greatest) *greatest = -5;
        return cudaSuccess;
    });
}

cudaError_t cudaDeviceSynchronize() {
    return call([&] {
        // A thread in relaxed mode invalidates a global capture, too.
        if (const cudaError_t error = leave_capture_alone(cudaStreamCaptureModeGlobal)) return error;
        drain_all();
        return cudaSuccess;
    });
}

cudaError_t cudaDriverGetVersion(int* value) {
    if (!value) return keep(cudaErrorInvalidValue);
    *value = settings().driver ? version : 0;
    return cudaSuccess;
}

cudaError_t cudaRuntimeGetVersion(int* value) {
    if (!value) return keep(cudaErrorInvalidValue);
    *value = version;
    return cudaSuccess;
}

cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total) {
    return call([&] {
        if (!free || !total) return cudaErrorInvalidValue;
        *total = settings().device_bytes;
        *free = *total - std::min(*total, memory::used());
        return cudaSuccess;
    });
}
