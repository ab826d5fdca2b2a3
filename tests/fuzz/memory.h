#pragma once

// The most memory that a piece of work has held at a time, counted by AddressSanitizer's hooks.

#include <cstdint>

namespace crumple::fuzz {

class MemoryWatch {
   public:
    MemoryWatch();
    MemoryWatch(const MemoryWatch&) = delete;
    MemoryWatch& operator=(const MemoryWatch&) = delete;
    ~MemoryWatch();

    /// Bytes, above what was held when the watch began.
    std::int64_t peak() const;
};

}  // namespace crumple::fuzz
