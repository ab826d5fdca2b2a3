#include "fuzz/memory.h"

#include <sanitizer/allocator_interface.h>

#include <algorithm>

#include "fuzz/fail.h"

namespace crumple::fuzz {
namespace {

// State of the only MemoryWatch. It is not synchronised, since readers start no threads.
bool watching = false;
std::int64_t held = 0, most = 0;

void on_allocation(const volatile void*, std::size_t size) {
    if (!watching) return;
    held += static_cast<std::int64_t>(size);
    most = std::max(most, held);
}

void on_release(const volatile void* memory) {
    if (watching && memory)
        held -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(const_cast<void*>(memory)));
}

}  // namespace

MemoryWatch::MemoryWatch() {
    static const int installed = __sanitizer_install_malloc_and_free_hooks(on_allocation, on_release);
    require(installed != 0, "no room for hooks of memory");
    held = most = 0;
    watching = true;
}

MemoryWatch::~MemoryWatch() { watching = false; }

std::int64_t MemoryWatch::peak() const { return most; }

}  // namespace crumple::fuzz
