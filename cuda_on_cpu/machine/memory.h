#pragma once

// Memory that cudaMalloc and its relatives hand out. Each allocation is filled with rubbish, begins at a multiple of
// 256 bytes as CUDA promises, and ends, up to that rounding, at a page that nobody may touch; the bytes between are
// watched until the allocation is freed. Freed pages stay untouchable for a while. Under AddressSanitizer an allocation
// is one of the heap, so that its redzones and its quarantine are as fine as any.

#include <cstddef>

namespace cuda_on_cpu {

enum class Kind { device, pinned, managed, registered };

struct Allocation {
    std::byte* begin = nullptr;
    std::size_t bytes = 0;
    Kind kind = Kind::device;
    int device = 0;
    bool open = true;  ///< false before and after its time in the order of a stream
};

namespace memory {

inline constexpr std::size_t alignment = 256;

/// Memory of `bytes` >= 1 bytes, null if the device has no more. Closed memory waits for open().
void* allocate(std::size_t bytes, Kind kind, int device, bool open = true);
/// Makes closed memory usable, with fresh rubbish.
void open(void* memory);
/// Gives memory back. An error if bytes beyond its end were written. False if nobody allocated it.
bool release(void* memory, Kind kind);
/// Pages that the caller allocated are pinned from now on.
bool register_host(void* memory, std::size_t bytes);
bool unregister_host(void* memory);

/// The allocation that holds `address`, null if none does.
const Allocation* find(const void* address);
/// True if [address, address + bytes) lies in one allocation.
bool covers(const void* address, std::size_t bytes);
/// Bytes of device and managed memory in use.
std::size_t used();
/// Allocations of any kind that nobody has freed yet: a test that ends with more than it began with has found a leak.
std::size_t live();

/// For messages: what lies at or just before `address` ("17 bytes past the end of ..."), into `text`.
void describe(const void* address, char* text, std::size_t size);

}  // namespace memory
}  // namespace cuda_on_cpu
