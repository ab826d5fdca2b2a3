// Storage of arrays: small blocks from operator new, large ones mapped by the system, which remaps them when they grow.

#include <cstddef>
#include <new>

#include "crumple/array.h"

// Sanitizers do not check mapped blocks, so under them all blocks come from operator new.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // g++
#define CRUMPLE_SANITIZED 1
#elif defined(__has_feature)  // clang++
#define CRUMPLE_SANITIZED \
    (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer))
#else
#define CRUMPLE_SANITIZED 0
#endif

#if defined(__linux__) && !CRUMPLE_SANITIZED
#define CRUMPLE_REMAPS
#include <sys/mman.h>
#endif

namespace crumple::detail {
namespace {

constexpr std::size_t alignment = 64;

#ifdef CRUMPLE_REMAPS
// glibc maps blocks of at least this size in any case. Smaller ones it may keep for reuse, which is faster.
constexpr std::size_t least_mapped = std::size_t{32} << 20;  // bytes

bool is_mapped(std::size_t bytes) { return bytes >= least_mapped; }

void* map(std::size_t bytes) {
    return mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
}
void unmap(void* storage, std::size_t bytes) noexcept { munmap(storage, bytes); }
void* remap(void* storage, std::size_t bytes, std::size_t new_bytes) {
    return mremap(storage, bytes, new_bytes, MREMAP_MAYMOVE);
}
void* const failed = MAP_FAILED;
#else
bool is_mapped(std::size_t) { return false; }
void* map(std::size_t) { return nullptr; }
void unmap(void*, std::size_t) noexcept {}
void* remap(void*, std::size_t, std::size_t) { return nullptr; }
void* const failed = nullptr;
#endif

void* checked(void* storage) {
    if (storage == failed) throw std::bad_alloc();
    return storage;
}

}  // namespace

void* allocate_storage(std::size_t bytes) {
    return is_mapped(bytes) ? checked(map(bytes)) : ::operator new (bytes, std::align_val_t{alignment});
}

void free_storage(void* storage, std::size_t bytes) noexcept {
    if (is_mapped(bytes))
        unmap(storage, bytes);
    else
        ::operator delete (storage, std::align_val_t{alignment});
}

bool can_grow_storage(std::size_t bytes) noexcept { return is_mapped(bytes); }

void* grow_storage(void* storage, std::size_t bytes, std::size_t new_bytes) {
    return checked(remap(storage, bytes, new_bytes));
}

}  // namespace crumple::detail
