// Memory of the machine that plays the device, for arrays of Python's tests.

#include <cuda_runtime.h>

#include <cstddef>

/// Never freed: tests are short. Null if it fails.
extern "C" __attribute__((visibility("default"))) void* crumple_test_device_memory(std::size_t bytes) {
    void* memory = nullptr;
    return cudaMalloc(&memory, bytes) == cudaSuccess ? memory : nullptr;
}
