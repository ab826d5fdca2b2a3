#pragma once

// Worlds side by side in one scene (PreparedScene::worlds), which never meet: their triangles lie world by world, and
// the first level of subdivision has the worlds as its parents. So no leaf holds triangles of two worlds, and no pair
// across worlds is ever a candidate.
//
//     triangles   │ world 0      │ 1 │  │ 3        │ ...       first, count: Segments (layout.h)
//     leaves      │ 0 │ 1 │ 2 │ 3 │ 4 │ ...                    as many for each world
//     found       │ 0             │ 1             │ ...        hits, where flags by world are asked for

#include <span>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

class Worlds {
   public:
    explicit Worlds(MemoryMeter& meter) : block_(meter) {}

    /// Those of a scene of the host, in none of which anything has been found. One takes no memory.
    void bring(cudaStream_t stream, const PreparedScene& host);
    /// Those that lie on the device already, and whose counters are whoever's has `found`; null: one has all.
    void share(const Segments& triangles, unsigned long long* found) { triangles_ = triangles, found_ = found; }
    /// A scene of one world comes next.
    void forget() { triangles_ = {}, found_ = nullptr; }
    void release();

    /// Each world's triangles; null: one world has all.
    const Segments& triangles() const { return triangles_; }
    /// Counted up by the kernels; null where there is one world.
    unsigned long long* found() const { return found_; }
    /// Sets the flags of those in which something has been found.
    void read(cudaStream_t stream, std::span<std::uint8_t> flags) const;

   private:
    Block block_;
    Segments triangles_{};
    unsigned long long* found_ = nullptr;
};

}  // namespace crumple::cuda
