// Allocates memory of the machine that plays the device, for arrays of the Python tests.

#include <cuda_runtime.h>

#include <cstddef>

/// Returns null on failure. The memory is never freed: tests are short.
extern "C" __attribute__((visibility("default"))) void* crumple_test_device_memory(std::size_t bytes) {
    void* memory = nullptr;
    return cudaMalloc(&memory, bytes) == cudaSuccess ? memory : nullptr;
}
