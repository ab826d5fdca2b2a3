#pragma once

// Wrappers of the CUDA runtime: calls that throw, launches, owners of streams, events and graphs. The same source
// compiles with nvcc and, with the headers of cuda_on_cpu/shim on the include path, as plain C++
// (cuda_on_cpu/README.md).

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace crumple::cuda {

/// Thrown by any call, even a launch, if the device has too little memory. `find` then searches in chunks.
struct OutOfDeviceMemory {
    std::string call;
    std::size_t bytes = 0;  ///< requested; 0: unknown

    std::string message() const;
};

/// Unless `error` is success, throws OutOfDeviceMemory, or Error (device) that names the call.
void check(cudaError_t error, const char* call);
#define CRUMPLE_CUDA(call) ::crumple::cuda::check(call, #call)

/// Returns the block's dynamic shared memory, which holds one struct per kernel. Only here do the two compilers see
/// different source.
template <class T>
__device__ T& dynamic_shared() {
#ifdef __CUDACC__
    extern __shared__ __align__(16) unsigned char raw[];
    return reinterpret_cast<T&>(*raw);
#else
    return cuda_on_cpu::dynamic_shared<T>();
#endif
}

/// Sets bytes of device memory. Zero bytes are allowed; CUDA itself refuses them in a capture.
inline void fill(cudaStream_t stream, void* memory, int value, std::size_t bytes) {
    if (bytes > 0) CRUMPLE_CUDA(cudaMemsetAsync(memory, value, bytes, stream));
}

/// Sets the calling thread's capture mode for the object's lifetime. In relaxed mode, allocating, freeing and waiting
/// do not invalidate another thread's capture, and are not refused because of it.
class CaptureMode {
   public:
    explicit CaptureMode(cudaStreamCaptureMode mode) : mode_(mode) { cudaThreadExchangeStreamCaptureMode(&mode_); }
    CaptureMode(const CaptureMode&) = delete;
    CaptureMode& operator=(const CaptureMode&) = delete;
    ~CaptureMode() { cudaThreadExchangeStreamCaptureMode(&mode_); }

   private:
    cudaStreamCaptureMode mode_;  ///< previous mode
};

/// Configuration of a launch. operator() launches a kernel, unless the grid is empty. Arguments are converted to the
/// types of the kernel's parameters.
struct Launch {
    cudaStream_t stream;
    dim3 blocks;
    unsigned threads;
    std::size_t shared = 0;

    template <class... Parameters, class... Arguments>
    void operator()(void (*kernel)(Parameters...), Arguments&&... arguments) const {
        if (blocks.x == 0 || blocks.y == 0) return;
        cudaLaunchConfig_t config{};
        config.gridDim = blocks;
        config.blockDim = threads;
        config.dynamicSmemBytes = shared;
        config.stream = stream;
        CRUMPLE_CUDA(cudaLaunchKernelEx(&config, kernel, static_cast<Parameters>(arguments)...));
    }
};

inline constexpr unsigned whole_warp = 0xffffffffu;

/// Sizes of launches. Tests choose fewer threads, so that the boundaries of blocks fall elsewhere.
struct Geometry {
    unsigned threads = 256;  ///< per block: 64 or 256
    unsigned resident = 0;   ///< blocks that fill the device
    unsigned multiprocessors = 0;

    /// Returns the number of blocks for one thread per element, but at most as many as fill the device: kernels use
    /// grid-stride loops.
    unsigned blocks(std::size_t elements) const {
        const std::size_t wanted = (elements + threads - 1) / threads;
        return static_cast<unsigned>(wanted < 1 ? 1 : wanted < resident ? wanted : resident);
    }

    /// Returns how many blocks of a kernel the device holds at once, given its registers and shared memory. `own`:
    /// threads per block, if not `threads`.
    template <class... Parameters>
    unsigned fitting(void (*kernel)(Parameters...), std::size_t shared = 0, unsigned own = 0) const {
        int blocks = 0;
        CRUMPLE_CUDA(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel,
                                                                   static_cast<int>(own ? own : threads), shared));
        return multiprocessors * static_cast<unsigned>(blocks < 1 ? 1 : blocks);
    }
};

/// Return the first element and the stride of a thread in a grid-stride loop.
__device__ inline std::size_t grid_thread() { return std::size_t{blockIdx.x} * blockDim.x + threadIdx.x; }
__device__ inline std::size_t grid_stride() { return std::size_t{gridDim.x} * blockDim.x; }

/// Returns the segment that contains an item: the last one with first[segment] <= item.
__device__ inline std::size_t segment_of(unsigned long long item, const unsigned long long* first,
                                         std::size_t segments) {
    std::size_t begin = 0, end = segments;
    while (end - begin > 1) {
        const std::size_t middle = (begin + end) / 2;
        if (first[middle] <= item)
            begin = middle;
        else
            end = middle;
    }
    return begin;
}

/// Reserves a place in a list for each lane that passes true, by adding the number of these lanes to *counter, and
/// returns the lane's place. All lanes of the warp call it together. The counter may exceed the capacity of the list,
/// so that the host learns how many places were needed.
__device__ inline unsigned long long append(bool wants, unsigned long long* counter) {
    const unsigned wanting = __ballot_sync(whole_warp, wants), lane = threadIdx.x % 32;
    unsigned long long first = 0;
    if (lane == 0 && wanting) first = atomicAdd(counter, static_cast<unsigned long long>(__popc(wanting)));
    first = __shfl_sync(whole_warp, first, 0);
    return first + static_cast<unsigned long long>(__popc(wanting & ((1u << lane) - 1)));
}

/// Adds the number of lanes with `holds` to *counter. All lanes of the warp call it together; none waits for the sum.
__device__ inline void tally(bool holds, unsigned long long* counter) {
    const unsigned holding = __ballot_sync(whole_warp, holds);
    if (threadIdx.x % 32 == 0 && holding) atomicAdd(counter, static_cast<unsigned long long>(__popc(holding)));
}

/// Returns true if *counter is not 0, so that the remaining work can be skipped; false if `counter` is null. All lanes
/// of the warp call it together. One lane reads the counter, so that all take the same branch.
__device__ inline bool has_ended(unsigned long long* counter) {
    if (!counter) return false;
    unsigned long long count = 0;
    if (threadIdx.x % 32 == 0) count = atomicAdd(counter, 0ull);
    return __shfl_sync(whole_warp, count, 0) != 0;
}

/// Owner of a handle that functions of the runtime create and destroy. Destroys it in relaxed mode: in another mode,
/// destroying a graph executable invalidates captures, of this thread or of others (cuda_on_cpu/README.md).
template <class Handle, cudaError_t (*destroy)(Handle)>
class Owner {
   public:
    Owner() = default;
    explicit Owner(Handle handle) : handle_(handle) {}
    Owner(Owner&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
    Owner& operator=(Owner&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Owner() {
        if (!handle_) return;
        const CaptureMode relaxed(cudaStreamCaptureModeRelaxed);
        destroy(handle_);
    }
    Handle get() const { return handle_; }
    explicit operator bool() const { return handle_ != nullptr; }

   private:
    Handle handle_ = nullptr;
};
using Stream = Owner<cudaStream_t, cudaStreamDestroy>;
using Event = Owner<cudaEvent_t, cudaEventDestroy>;
using Graph = Owner<cudaGraph_t, cudaGraphDestroy>;
using GraphExec = Owner<cudaGraphExec_t, cudaGraphExecDestroy>;

}  // namespace crumple::cuda
