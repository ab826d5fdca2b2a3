// Allocates memory of the emulated device, for arrays of the Python tests.

#include <cuda_runtime.h>

#include <cstddef>

/// Returns device memory, or null on failure. It is never freed, since tests are short.
extern "C" __attribute__((visibility("default"))) void* crumple_test_device_memory(std::size_t bytes) {
    void* memory = nullptr;
    return cudaMalloc(&memory, bytes) == cudaSuccess ? memory : nullptr;
}
