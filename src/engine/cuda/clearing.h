#pragma once

// What a pass begins with: arrays that are set to a value, all by one kernel, for each memset would be a node of its
// own in a graph, and wait for the one before.

#include <cstddef>

#include "engine/cuda/runtime.h"

namespace crumple::cuda {

class Clearing {
   public:
    /// `bytes` from `memory` on are to hold `word` again and again; both are multiples of four. Ranges must not
    /// overlap.
    void add(void* memory, std::size_t bytes, unsigned word = 0);
    void launch(const Geometry& geometry, cudaStream_t stream) const;

    struct Range {
        unsigned* begin;
        std::size_t words;
        unsigned word;
    };
    struct Ranges {
        Range range[24];
        int count = 0;
    };

   private:
    Ranges ranges_;
};

}  // namespace crumple::cuda
