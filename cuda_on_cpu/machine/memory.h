#pragma once

// Memory of cudaMalloc and related functions. Each allocation is filled with rubbish, begins at a multiple of 256 bytes
// as CUDA promises, and ends, up to that rounding, at an inaccessible guard page. The bytes in between are canaries,
// checked when the allocation is freed. Freed pages stay inaccessible for a while. Under AddressSanitizer allocations
// come from the heap, with its redzones and its quarantine.

#include <cstddef>

namespace cuda_on_cpu {

enum class Kind { device, pinned, managed, registered };

struct Allocation {
    std::byte* begin = nullptr;
    std::size_t bytes = 0;
    Kind kind = Kind::device;
    int device = 0;
    bool open = true;  ///< false until its stream reaches cudaMallocAsync; accessible if true
};

namespace memory {

inline constexpr std::size_t alignment = 256;

/// Allocates `bytes` >= 1 bytes. Returns null if the device has no more. Closed memory is inaccessible until open().
void* allocate(std::size_t bytes, Kind kind, int device, bool open = true);
/// Makes closed memory accessible and fills it with rubbish.
void open(void* memory);
/// Frees memory. An error if canaries around it were overwritten. Returns false if `memory` is no allocation of `kind`.
bool release(void* memory, Kind kind);
/// Marks memory of the caller as pinned. Returns false if `memory` lies in an allocation already.
bool register_host(void* memory, std::size_t bytes);
bool unregister_host(void* memory);

/// Returns the allocation that holds `address`; null if none does.
const Allocation* find(const void* address);
/// True if [address, address + bytes) lies in one allocation.
bool covers(const void* address, std::size_t bytes);
/// Returns the bytes of device and managed memory in use.
std::size_t used();
/// Returns the number of live allocations of any kind. A test that ends with more than it began with has found a leak.
std::size_t live();

/// Describes what lies at or just before `address` in `text`, for messages ("17 bytes past the end of ...").
void describe(const void* address, char* text, std::size_t size);

}  // namespace memory
}  // namespace cuda_on_cpu
