#pragma once

// Measures the peak memory of an operation by the allocation hooks of AddressSanitizer.

#include <cstdint>

namespace crumple::fuzz {

/// Measures from construction to destruction. Only one instance may exist at a time, in a process with one thread.
class MemoryWatch {
   public:
    MemoryWatch();
    MemoryWatch(const MemoryWatch&) = delete;
    MemoryWatch& operator=(const MemoryWatch&) = delete;
    ~MemoryWatch();

    /// Returns the peak in bytes, above the memory in use at construction.
    std::int64_t peak() const;
};

}  // namespace crumple::fuzz
