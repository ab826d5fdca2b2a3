#pragma once

// Bytes that a MemoryMeter counts for the lifetime of an object, for containers such as std::vector, which do not
// report their memory to the meter.

#include <atomic>
#include <cstdint>
#include <vector>

#include "crumple/array.h"

namespace crumple {

template <class T>
std::size_t bytes_of(const std::vector<T>& vector) {
    return vector.capacity() * sizeof(T);
}

class MemoryClaim {
   public:
    explicit MemoryClaim(MemoryMeter& meter) : meter_(meter) {}
    ~MemoryClaim() { meter_.add(-bytes_.load()); }
    MemoryClaim(const MemoryClaim&) = delete;
    MemoryClaim& operator=(const MemoryClaim&) = delete;

    /// Adds to the claim. Throws MemoryMeter::Exceeded, without a change, if the meter's limit would be exceeded.
    /// Thread-safe.
    void add(std::size_t bytes) {
        meter_.add(static_cast<std::int64_t>(bytes));
        bytes_ += static_cast<std::int64_t>(bytes);
    }
    /// Removes all bytes from the claim.
    void release() { meter_.add(-bytes_.exchange(0)); }
    std::size_t bytes() const { return static_cast<std::size_t>(bytes_.load()); }

   private:
    MemoryMeter& meter_;
    std::atomic<std::int64_t> bytes_{0};
};

}  // namespace crumple
