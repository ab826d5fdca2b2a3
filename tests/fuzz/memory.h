#pragma once

// Measures the peak memory of a piece of work by the allocation hooks of AddressSanitizer.

#include <cstdint>

namespace crumple::fuzz {

/// Measures from construction to destruction. One instance at a time, in one thread.
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
