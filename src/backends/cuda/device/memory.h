#pragma once

// Device memory, counted by the detector's meter, and pinned host memory.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/runtime.h"
#include "crumple/array.h"

namespace crumple::cuda {

/// Block of device memory. Its address changes only if it has to grow, which loses the contents.
class Block {
   public:
    explicit Block(MemoryMeter& meter) : meter_(meter) {}
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;
    ~Block() { release(); }

    std::byte* resize(std::size_t bytes) {
        if (bytes > capacity_) grow(bytes);
        return data_;
    }
    const void* data() const { return data_; }
    std::size_t capacity() const { return capacity_; }
    void release() {
        if (!data_) return;
        const CaptureMode relaxed(cudaStreamCaptureModeRelaxed);
        if (cudaFree(data_) != cudaSuccess) cudaGetLastError();  // the device has failed, and all its memory is gone
        meter_.add(-static_cast<std::int64_t>(capacity_));
        data_ = nullptr;
        capacity_ = 0;
    }

   private:
    void grow(std::size_t bytes) {
        release();
        meter_.add(static_cast<std::int64_t>(bytes));
        const CaptureMode relaxed(cudaStreamCaptureModeRelaxed);
        void* memory = nullptr;
        const cudaError_t error = cudaMalloc(&memory, bytes);
        if (error != cudaSuccess) {
            meter_.add(-static_cast<std::int64_t>(bytes));
            cudaGetLastError();  // else the next check would report it
            if (error == cudaErrorMemoryAllocation) throw OutOfDeviceMemory{"cudaMalloc", bytes};
            check(error, "cudaMalloc");
        }
        data_ = static_cast<std::byte*>(memory);
        capacity_ = bytes;
    }

    MemoryMeter& meter_;
    std::byte* data_ = nullptr;
    std::size_t capacity_ = 0;
};

/// Runs work(). Returns false if device memory or the memory limit did not suffice.
template <class Work>
bool fits(Work work) {
    try {
        work();
        return true;
    } catch (const MemoryMeter::Exceeded&) {
    } catch (const OutOfDeviceMemory&) {
    }
    return false;
}

/// Returns the bytes that the lists of a search in chunks may take (engine/finder_chunks.cu): a quarter of the memory
/// left, because members and results grow, too.
inline std::int64_t bytes_for_lists(const MemoryMeter& meter) {
    std::size_t free = 0, total = 0;
    CRUMPLE_CUDA(cudaMemGetInfo(&free, &total));
    const auto left = static_cast<std::int64_t>(free);
    return (meter.limit > 0 ? std::clamp<std::int64_t>(meter.limit - meter.used, 0, left) : left) / 4;
}

/// Copies n elements, and returns once the copy is complete.
template <class T>
void copy_now(cudaStream_t stream, T* to, const T* from, std::size_t n, cudaMemcpyKind kind) {
    if (n == 0) return;
    CRUMPLE_CUDA(cudaMemcpyAsync(to, from, n * sizeof(T), kind, stream));
    CRUMPLE_CUDA(cudaStreamSynchronize(stream));
}

/// Divides a block into arrays, one after another. Without a block, only measures how much memory the arrays need.
class ArenaLayout {
   public:
    explicit ArenaLayout(std::byte* block = nullptr) : block_(block) {}
    template <class T>
    /// Returns the next n elements of the block; null without a block.
    T* take(std::size_t n) {
        static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignment);
        const std::size_t begin = used_;
        used_ += (n * sizeof(T) + alignment - 1) / alignment * alignment;
        return block_ ? reinterpret_cast<T*>(block_ + begin) : nullptr;
    }
    std::size_t used() const { return used_; }

   private:
    static constexpr std::size_t alignment = 256;
    std::byte* block_;
    std::size_t used_ = 0;
};

/// Permission of a block to grow. Blocks are fixed for work that goes into a caller's capture, during which nothing may
/// be allocated.
enum class Growth : std::uint8_t { grows, fixed };
/// Thrown if memory would have to grow, or data to be uploaded, in spite of Growth::fixed.
struct CapacityError {};

/// Makes the arena layout of a block. Calls cut(cutter), which takes one array after the other, twice: to measure, then
/// to place them.
template <class Cut>
void place_arrays(Block& block, Cut cut, Growth growth = Growth::grows) {
    ArenaLayout measure;
    cut(measure);
    if (growth == Growth::fixed && measure.used() > block.capacity()) throw CapacityError{};
    ArenaLayout cutter(block.resize(measure.used()));
    cut(cutter);
}

/// One T in pinned host memory, which graphs write to.
template <class T>
class Pinned {
    static_assert(std::is_trivially_copyable_v<T>);

   public:
    explicit Pinned(const Device& device) {
        const Device::Current current(device);
        void* memory = nullptr;
        CRUMPLE_CUDA(cudaMallocHost(&memory, sizeof(T)));
        value_ = new (memory) T();
    }
    Pinned(const Pinned&) = delete;
    Pinned& operator=(const Pinned&) = delete;
    ~Pinned() {
        const CaptureMode relaxed(cudaStreamCaptureModeRelaxed);
        cudaFreeHost(value_);
    }
    T* get() const { return value_; }
    T* operator->() const { return value_; }
    T& operator*() const { return *value_; }

   private:
    T* value_ = nullptr;
};

}  // namespace crumple::cuda
