#pragma once

// Batched clear: sets arrays to values, and copies arrays, in one kernel. Every pass begins with one. As separate
// memsets and copies, each would be a node of a graph that waits for the one before.

#include <cstddef>

#include "backends/cuda/device/runtime.h"

namespace crumple::cuda {

class BatchedClear {
   public:
    /// Adds `bytes` bytes from `memory` on, to be filled with copies of `word`. Address and size must be multiples of
    /// four. Ranges must not overlap.
    void add(void* memory, std::size_t bytes, unsigned word = 0);
    /// Adds a copy of `bytes` bytes, a multiple of four, from `from` to `memory`.
    void copy(void* memory, const void* from, std::size_t bytes);
    void launch(const Geometry& geometry, cudaStream_t stream) const;

    struct Range {
        unsigned* begin;
        std::size_t words;
        unsigned word;
        const unsigned* from;  ///< source of a copy; null: fill with `word`
    };
    struct Ranges {
        Range range[24];
        int count = 0;
    };

   private:
    void add(const Range& range);

    Ranges ranges_;
};

}  // namespace crumple::cuda
