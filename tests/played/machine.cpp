// Settings of the emulated device in tests of the cuda backend: one multiprocessor, so that each call starts few
// threads, unless CUDA_ON_CPU_MULTIPROCESSORS sets another number; and all sums over overlaps on the device. The
// variable CUDA_BLOCK_THREADS (64 or 256) sets the number of threads per block.

#include <cstddef>
#include <cstdlib>
#include <string>

#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/overlaps/device_overlaps.h"
#include "cuda_on_cpu/machine/settings.h"

namespace {

const bool chosen = [] {
    if (!std::getenv("CUDA_ON_CPU_MULTIPROCESSORS")) cuda_on_cpu::settings().multiprocessors = 1;
    crumple::cuda::least_crossed_pairs = crumple::cuda::least_summed_faces = 1;
    crumple::cuda::surface_bytes_per_pair = std::size_t{1} << 40;
    if (const char* threads = std::getenv("CUDA_BLOCK_THREADS"))
        crumple::cuda::block_threads = static_cast<unsigned>(std::stoi(threads));
    return true;
}();

}  // namespace
