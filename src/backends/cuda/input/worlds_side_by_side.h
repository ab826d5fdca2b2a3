#pragma once

// Worlds side by side in one scene (PreparedScene::worlds), which are never paired: triangles are ordered by world, and
// the first level of subdivision has the worlds as its parents. So no leaf holds triangles of two worlds, and no pair
// across worlds is ever a candidate.
//
//     triangles   │ world 0      │ 1 │  │ 3        │ ...       first, count: Segments (layout.h)
//     leaves      │ 0 │ 1 │ 2 │ 3 │ 4 │ ...                    equally many for each world
//     found       │ 0             │ 1             │ ...        hits, for flags by world

#include <span>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

class Worlds {
   public:
    explicit Worlds(MemoryMeter& meter) : block_(meter) {}

    /// Uploads the worlds of a scene on the host, and clears their counters of hits. A single world takes no memory.
    void bring(cudaStream_t stream, const PreparedScene& host);
    /// Refers to worlds on the device, and to their counters of hits, both owned by the caller; null: a single world.
    void share(const Segments& triangles, unsigned long long* found) { triangles_ = triangles, found_ = found; }
    /// Resets this to a single world.
    void forget() { triangles_ = {}, found_ = nullptr; }
    void release();

    /// Returns each world's triangles; null: a single world.
    const Segments& triangles() const { return triangles_; }
    /// Returns the counters of hits, which kernels increment; null for a single world.
    unsigned long long* found() const { return found_; }
    /// Sets the flags of the worlds that have a hit.
    void read(cudaStream_t stream, std::span<std::uint8_t> flags) const;

   private:
    Block block_;
    Segments triangles_{};
    unsigned long long* found_ = nullptr;
};

}  // namespace crumple::cuda
