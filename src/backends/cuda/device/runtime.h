#pragma once

// The CUDA runtime, wrapped: calls that throw, launches, owners of streams, events and graphs. The same text compiles
// with nvcc and, with the headers of cuda_on_cpu/shim on the include path, as plain C++ (cuda_on_cpu/README.md).

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace crumple::cuda {

/// Thrown where the device has no more memory, whichever call it was: launches take some, too. `find` then works in
/// chunks.
struct OutOfDeviceMemory {
    std::string call;
    std::size_t bytes = 0;  ///< that were asked for; 0: not known

    std::string message() const;
};

/// Unless `error` is success, throws OutOfDeviceMemory, or Error (device) that names the call.
void check(cudaError_t error, const char* call);
#define CRUMPLE_CUDA(call) ::crumple::cuda::check(call, #call)

/// The block's dynamic shared memory: one struct a kernel. The one place where the two compilers see different text.
template <class T>
__device__ T& dynamic_shared() {
#ifdef __CUDACC__
    extern __shared__ __align__(16) unsigned char raw[];
    return reinterpret_cast<T&>(*raw);
#else
    return cuda_on_cpu::dynamic_shared<T>();
#endif
}

/// Sets bytes of the device. None are fine, even in a capture, where CUDA itself refuses them.
inline void fill(cudaStream_t stream, void* memory, int value, std::size_t bytes) {
    if (bytes > 0) CRUMPLE_CUDA(cudaMemsetAsync(memory, value, bytes, stream));
}

/// How the calling thread minds captures, while it lives. Relaxed: what we allocate, free or wait for does not spoil
/// the capture of another thread, and is not refused because of it.
class CaptureMode {
   public:
    explicit CaptureMode(cudaStreamCaptureMode mode) : mode_(mode) { cudaThreadExchangeStreamCaptureMode(&mode_); }
    CaptureMode(const CaptureMode&) = delete;
    CaptureMode& operator=(const CaptureMode&) = delete;
    ~CaptureMode() { cudaThreadExchangeStreamCaptureMode(&mode_); }

   private:
    cudaStreamCaptureMode mode_;  ///< the one before
};

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

/// How kernels are launched. Tests choose fewer threads, so that blocks and warps meet in other ways.
struct Geometry {
    unsigned threads = 256;  ///< of a block: 64 or 256
    unsigned resident = 0;   ///< blocks that fill the device
    unsigned multiprocessors = 0;

    /// Blocks for one thread an element, no more than fill the device: kernels stride on.
    unsigned blocks(std::size_t elements) const {
        const std::size_t wanted = (elements + threads - 1) / threads;
        return static_cast<unsigned>(wanted < 1 ? 1 : wanted < resident ? wanted : resident);
    }

    /// Blocks of one kernel that the device holds at once, by its registers and shared memory: more would wait for
    /// them. `own`: threads of its blocks, if they are others.
    template <class... Parameters>
    unsigned fitting(void (*kernel)(Parameters...), std::size_t shared = 0, unsigned own = 0) const {
        int blocks = 0;
        CRUMPLE_CUDA(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel,
                                                                   static_cast<int>(own ? own : threads), shared));
        return multiprocessors * static_cast<unsigned>(blocks < 1 ? 1 : blocks);
    }
};

/// First element and stride of a thread that shares a loop with the whole grid.
__device__ inline std::size_t grid_thread() { return std::size_t{blockIdx.x} * blockDim.x + threadIdx.x; }
__device__ inline std::size_t grid_stride() { return std::size_t{gridDim.x} * blockDim.x; }

/// The segment that holds an item, by prefix sums: the last whose first item is not behind it.
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

/// Gives each lane that wants one a place of its own behind *counter; all lanes of the warp call it together. The
/// counter counts on when places run out, so that the host learns how many were wanted.
__device__ inline unsigned long long append(bool wants, unsigned long long* counter) {
    const unsigned wanting = __ballot_sync(whole_warp, wants), lane = threadIdx.x % 32;
    unsigned long long first = 0;
    if (lane == 0 && wanting) first = atomicAdd(counter, static_cast<unsigned long long>(__popc(wanting)));
    first = __shfl_sync(whole_warp, first, 0);
    return first + static_cast<unsigned long long>(__popc(wanting & ((1u << lane) - 1)));
}

/// Counts the lanes that hold, for all lanes of the warp together. No lane waits for the sum.
__device__ inline void tally(bool holds, unsigned long long* counter) {
    const unsigned holding = __ballot_sync(whole_warp, holds);
    if (threadIdx.x % 32 == 0 && holding) atomicAdd(counter, static_cast<unsigned long long>(__popc(holding)));
}

/// Whether something has been counted, so that the rest of the work need not be done; null: go on whatever there is.
/// One lane looks, and all lanes of the warp, which call it together, go the same way.
__device__ inline bool has_ended(unsigned long long* counter) {
    if (!counter) return false;
    unsigned long long count = 0;
    if (threadIdx.x % 32 == 0) count = atomicAdd(counter, 0ull);
    return __shfl_sync(whole_warp, count, 0) != 0;
}

/// Owner of a handle that is created and destroyed by functions of the runtime. Destroys it in relaxed mode:
/// in another, destroying a graph executable invalidates captures, of this thread or of others (cuda_on_cpu/README.md).
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
