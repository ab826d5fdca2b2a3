#pragma once

// Queries on worlds whose poses lie on the device: uploads their bodies, caches these on the device between calls, and
// makes results for the host.

#include <memory>

#include "backends/cuda/input/posed_worlds.h"
#include "backends/cuda/intersections/intersection_finder.h"
#include "base/parallel_for.h"
#include "crumple/world.h"

namespace crumple::cuda {

class PosedWorldCalls {
   public:
    PosedWorldCalls(IntersectionFinder& finder, cudaStream_t stream, MemoryMeter& meter);

    /// Returns the world's bodies on the device; uploads them unless they are those of the previous call. Null if one
    /// scene cannot hold them. Throws CapacityError if `growth` is fixed and they would have to be uploaded.
    std::shared_ptr<const PosedWorlds> bodies_of(const World& world, const PairFilter& rules, ParallelFor& workers,
                                                 Growth growth = Growth::grows);

    /// Fills the result. The backend's own stream must already wait for the stream of the poses. Returns false if one
    /// scene cannot hold the worlds. Throws MemoryMeter::Exceeded if memory does not hold all of them at once.
    bool find(const World& world, const IntersectionQuery& query, ParallelFor& workers, Intersections& result);

    void release();

   private:
    void find_flags(const PosedWorlds& worlds, Output wants, Intersections& result);

    IntersectionFinder& finder_;
    cudaStream_t stream_;
    MemoryMeter& meter_;
    std::shared_ptr<const PosedWorlds> known_;
    Intersections found_;
};

}  // namespace crumple::cuda
