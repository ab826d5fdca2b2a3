// Runtime API: allocation, copies, fills.

#include <algorithm>
#include <cstring>
#include <memory>

#include "cuda_on_cpu/machine/call.h"
#include "cuda_on_cpu/machine/launch.h"
#include "cuda_on_cpu/machine/memory.h"
#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/runtime_api.h"

/// Memory pool, one for all devices. It holds nothing in reserve, so its threshold is stored and has no effect.
struct CUmemPoolHandle_st {
    std::uint64_t release_threshold = 0;
};

using namespace cuda_on_cpu;

namespace {

CUmemPoolHandle_st default_pool;

cudaError_t allocate(void** result, std::size_t bytes, Kind kind) {
    if (!result) return cudaErrorInvalidValue;
    if (const cudaError_t error = leave_capture_alone()) return error;
    *result = nullptr;
    if (bytes == 0) return cudaSuccess;
    *result = memory::allocate(bytes, kind, host_thread().device);
    return *result ? cudaSuccess : cudaErrorMemoryAllocation;
}

/// Frees memory after all pending work is done, as cudaFree does.
cudaError_t release(void* pointer, Kind kind) {
    if (const cudaError_t error = leave_capture_alone()) return error;
    if (!pointer) return cudaSuccess;
    drain_all();
    return memory::release(pointer, kind) ? cudaSuccess : cudaErrorInvalidValue;
}

/// Kind of memory at an address. An address just past an allocation counts as pageable memory, so it is refused as
/// device memory.
struct Place {
    bool on_device = false, on_host = true, pinned = false;
    explicit Place(const void* address) {
        const Allocation* a = memory::find(address);
        if (!a) return;
        on_device = a->kind != Kind::registered && a->kind != Kind::pinned;
        on_host = a->kind != Kind::device;
        pinned = on_host;
    }
};

struct Copy {
    std::byte* to;
    const std::byte* from;
    std::size_t to_pitch, from_pitch, width, height;

    std::size_t to_bytes() const { return to_pitch * (height - 1) + width; }
    std::size_t from_bytes() const { return from_pitch * (height - 1) + width; }
    void run() const {
        for (std::size_t row = 0; row < height; ++row) std::memcpy(to + row * to_pitch, from + row * from_pitch, width);
    }
};

/// Checks that the kind fits both addresses, and that allocations of the machine hold the whole range.
cudaError_t check(const Copy& copy, cudaMemcpyKind kind) {
    const Place to(copy.to), from(copy.from);
    const bool fits = kind == cudaMemcpyHostToHost       ? to.on_host && from.on_host
                      : kind == cudaMemcpyHostToDevice   ? to.on_device && from.on_host
                      : kind == cudaMemcpyDeviceToHost   ? to.on_host && from.on_device
                      : kind == cudaMemcpyDeviceToDevice ? to.on_device && from.on_device
                                                         : kind == cudaMemcpyDefault;
    if (!fits) return cudaErrorInvalidValue;
    if ((to.on_device || to.pinned) && !memory::covers(copy.to, copy.to_bytes())) return cudaErrorInvalidValue;
    if ((from.on_device || from.pinned) && !memory::covers(copy.from, copy.from_bytes())) return cudaErrorInvalidValue;
    return cudaSuccess;
}

/// Handles a copy or fill of no bytes. It is an error during a capture, because a graph has no empty nodes.
cudaError_t enqueue_nothing(cudaStream_t handle) {
    const CUstream_st* stream = stream_of(handle);
    if (!stream) return cudaErrorInvalidResourceHandle;
    if (!stream->capture) return cudaSuccess;
    stream->capture->invalid = true;
    return cudaErrorInvalidValue;
}

/// Enqueues a copy. Pageable memory is read, or written, before the call returns. A graph runs later, so pageable
/// memory is refused during a capture.
cudaError_t enqueue_copy(Copy copy, cudaMemcpyKind kind, cudaStream_t handle) {
    if (copy.width == 0 || copy.height == 0) return enqueue_nothing(handle);
    ++work_count().copies;
    if (!copy.to || !copy.from) return cudaErrorInvalidValue;
    if (copy.to_pitch < copy.width || copy.from_pitch < copy.width) return cudaErrorInvalidPitchValue;
    if (const cudaError_t error = check(copy, kind)) return error;
    const Place to(copy.to), from(copy.from);
    const bool reads_pageable = from.on_host && !from.pinned, writes_pageable = to.on_host && !to.pinned;
    if (!reads_pageable && !writes_pageable)
        return enqueue(handle, {Work::Kind::copy, nullptr, [copy] { copy.run(); }});
    std::shared_ptr<std::byte[]> staged;
    if (reads_pageable) {
        staged = std::shared_ptr<std::byte[]>(new std::byte[copy.width * copy.height]);
        const Copy stage{staged.get(), copy.from, copy.width, copy.from_pitch, copy.width, copy.height};
        stage.run();
        copy.from = staged.get();
        copy.from_pitch = copy.width;
    }
    if (const cudaError_t error = enqueue_uncaptured(handle, [copy, staged] { copy.run(); })) return error;
    if (writes_pageable) drain(stream_of(handle));
    return cudaSuccess;
}

Copy flat(void* to, const void* from, std::size_t bytes) {
    return {static_cast<std::byte*>(to), static_cast<const std::byte*>(from), bytes, bytes, bytes, bytes ? 1u : 0u};
}

/// Copies in the legacy stream and waits for the end. Only a capture of a blocking stream forbids that.
cudaError_t copy_and_wait(const Copy& copy, cudaMemcpyKind kind) {
    if (const cudaError_t error = enqueue_copy(copy, kind, nullptr)) return error;
    drain(stream_of(nullptr));
    return cudaSuccess;
}

cudaError_t enqueue_set(void* pointer, int value, std::size_t bytes, cudaStream_t stream) {
    if (bytes == 0) return enqueue_nothing(stream);
    if (!memory::covers(pointer, bytes)) return cudaErrorInvalidValue;
    return enqueue(stream, {Work::Kind::set, nullptr, [=] { std::memset(pointer, value, bytes); }});
}

}  // namespace

cudaError_t cudaMalloc(void** pointer, std::size_t bytes) {
    return call([&] { return allocate(pointer, bytes, Kind::device); });
}
cudaError_t cudaFree(void* pointer) {
    return call([&] { return release(pointer, Kind::device); });
}
cudaError_t cudaMallocHost(void** pointer, std::size_t bytes, unsigned) {
    return call([&] { return allocate(pointer, bytes, Kind::pinned); });
}
cudaError_t cudaHostAlloc(void** pointer, std::size_t bytes, unsigned) {
    return call([&] { return allocate(pointer, bytes, Kind::pinned); });
}
cudaError_t cudaFreeHost(void* pointer) {
    return call([&] { return release(pointer, Kind::pinned); });
}
cudaError_t cudaMallocManaged(void** pointer, std::size_t bytes, unsigned) {
    return call([&] { return allocate(pointer, bytes, Kind::managed); });
}

cudaError_t cudaHostRegister(void* pointer, std::size_t bytes, unsigned) {
    return call([&] {
        if (!pointer || !bytes) return cudaErrorInvalidValue;
        if (const cudaError_t error = leave_capture_alone()) return error;
        return memory::register_host(pointer, bytes) ? cudaSuccess : cudaErrorHostMemoryAlreadyRegistered;
    });
}
cudaError_t cudaHostUnregister(void* pointer) {
    return call([&] {
        if (const cudaError_t error = leave_capture_alone()) return error;
        drain_all();
        return memory::unregister_host(pointer) ? cudaSuccess : cudaErrorHostMemoryNotRegistered;
    });
}
cudaError_t cudaHostGetDevicePointer(void** device, void* host, unsigned) {
    return call([&] {
        const Allocation* a = memory::find(host);
        if (!device || !a || a->kind == Kind::device) return cudaErrorInvalidValue;
        *device = host;
        return cudaSuccess;
    });
}

cudaError_t cudaMallocAsync(void** pointer, std::size_t bytes, cudaStream_t stream) {
    return call([&] {
        if (!pointer) return cudaErrorInvalidValue;
        *pointer = nullptr;
        if (bytes == 0) return cudaSuccess;
        void* const result = memory::allocate(bytes, Kind::device, host_thread().device, false);
        if (!result) return cudaErrorMemoryAllocation;
        const cudaError_t error = enqueue_uncaptured(stream, [result] { memory::open(result); });
        if (error)
            memory::release(result, Kind::device);
        else
            *pointer = result;
        return error;
    });
}
cudaError_t cudaMallocFromPoolAsync(void** pointer, std::size_t bytes, cudaMemPool_t pool, cudaStream_t stream) {
    return pool == &default_pool ? cudaMallocAsync(pointer, bytes, stream) : keep(cudaErrorInvalidValue);
}
cudaError_t cudaFreeAsync(void* pointer, cudaStream_t stream) {
    return call([&] {
        if (!pointer) return cudaSuccess;
        const Allocation* a = memory::find(pointer);
        if (!a || a->begin != pointer || a->kind != Kind::device) return cudaErrorInvalidValue;
        return enqueue_uncaptured(stream, [pointer] {
            if (!memory::release(pointer, Kind::device)) fail("memory is freed twice in stream order");
        });
    });
}

cudaError_t cudaDeviceGetDefaultMemPool(cudaMemPool_t* pool, int device) {
    return call([&] {
        if (!pool || device < 0 || device >= settings().devices) return cudaErrorInvalidValue;
        *pool = &default_pool;
        return cudaSuccess;
    });
}
cudaError_t cudaDeviceGetMemPool(cudaMemPool_t* pool, int device) { return cudaDeviceGetDefaultMemPool(pool, device); }

cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t pool, cudaMemPoolAttr attribute, void* value) {
    return call([&] {
        if (pool != &default_pool || !value) return cudaErrorInvalidValue;
        if (attribute == cudaMemPoolAttrReleaseThreshold) pool->release_threshold = *static_cast<std::uint64_t*>(value);
        return cudaSuccess;
    });
}
cudaError_t cudaMemPoolGetAttribute(cudaMemPool_t pool, cudaMemPoolAttr attribute, void* value) {
    return call([&] {
        if (pool != &default_pool || !value) return cudaErrorInvalidValue;
        switch (attribute) {
            case cudaMemPoolAttrReleaseThreshold:
                *static_cast<std::uint64_t*>(value) = pool->release_threshold;
                return cudaSuccess;
            case cudaMemPoolAttrReservedMemCurrent:
            case cudaMemPoolAttrUsedMemCurrent:
                *static_cast<std::uint64_t*>(value) = memory::used();
                return cudaSuccess;
            default:
                return cudaErrorNotSupported;
        }
    });
}
cudaError_t cudaMemPoolTrimTo(cudaMemPool_t pool, std::size_t) {
    return call([&] { return pool == &default_pool ? cudaSuccess : cudaErrorInvalidValue; });
}

cudaError_t cudaPointerGetAttributes(cudaPointerAttributes* attributes, const void* pointer) {
    return call([&] {
        if (!attributes) return cudaErrorInvalidValue;
        const Allocation* a = memory::find(pointer);
        void* const address = const_cast<void*>(pointer);
        if (!a)
            *attributes = {cudaMemoryTypeUnregistered, -2, nullptr, address};
        else if (a->kind == Kind::device)
            *attributes = {cudaMemoryTypeDevice, a->device, address, nullptr};
        else if (a->kind == Kind::managed)
            *attributes = {cudaMemoryTypeManaged, a->device, address, address};
        else
            *attributes = {cudaMemoryTypeHost, a->device, address, address};
        return cudaSuccess;
    });
}

cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
    return call([&] { return copy_and_wait(flat(to, from, bytes), kind); });
}
cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind, cudaStream_t stream) {
    return call([&] { return enqueue_copy(flat(to, from, bytes), kind, stream); });
}
cudaError_t cudaMemcpy2D(void* to, std::size_t to_pitch, const void* from, std::size_t from_pitch, std::size_t width,
                         std::size_t height, cudaMemcpyKind kind) {
    return call([&] {
        return copy_and_wait(
            {static_cast<std::byte*>(to), static_cast<const std::byte*>(from), to_pitch, from_pitch, width, height},
            kind);
    });
}
cudaError_t cudaMemcpy2DAsync(void* to, std::size_t to_pitch, const void* from, std::size_t from_pitch,
                              std::size_t width, std::size_t height, cudaMemcpyKind kind, cudaStream_t stream) {
    return call([&] {
        return enqueue_copy(
            {static_cast<std::byte*>(to), static_cast<const std::byte*>(from), to_pitch, from_pitch, width, height},
            kind, stream);
    });
}
cudaError_t cudaMemset(void* pointer, int value, std::size_t bytes) {
    return call([&] { return enqueue_set(pointer, value, bytes, nullptr); });  // the host does not wait
}
cudaError_t cudaMemsetAsync(void* pointer, int value, std::size_t bytes, cudaStream_t stream) {
    return call([&] { return enqueue_set(pointer, value, bytes, stream); });
}
