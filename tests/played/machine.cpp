// The machine that plays the device for the backend's tests: small, so that each call starts few threads. The variable
// CUDA_BLOCK_THREADS (64 or 256) chooses how many a block has.

#include <cstdlib>
#include <string>

#include "backends/cuda/device/cuda_device.h"
#include "cuda_on_cpu/machine/settings.h"

namespace {

const bool chosen = [] {
    cuda_on_cpu::settings().multiprocessors = 1;
    if (const char* threads = std::getenv("CUDA_BLOCK_THREADS"))
        crumple::cuda::block_threads = static_cast<unsigned>(std::stoi(threads));
    return true;
}();

}  // namespace
