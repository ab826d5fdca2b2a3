#pragma once

// What a pass begins with: arrays that are set to a value, and copies of what the pass before has left, all by one
// kernel, for each memset or copy would be a node of its own in a graph, and wait for the one before.

#include <cstddef>

#include "backends/cuda/device/runtime.h"

namespace crumple::cuda {

class Clearing {
   public:
    /// `bytes` from `memory` on are to hold `word` again and again; both are multiples of four. Ranges must not
    /// overlap.
    void add(void* memory, std::size_t bytes, unsigned word = 0);
    /// `bytes` from `from` on, a multiple of four, are copied.
    void copy(void* memory, const void* from, std::size_t bytes);
    void launch(const Geometry& geometry, cudaStream_t stream) const;

    struct Range {
        unsigned* begin;
        std::size_t words;
        unsigned word;
        const unsigned* from;  ///< null: the word
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
