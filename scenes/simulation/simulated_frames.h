#pragma once

// Frames of a simulation: read from the cache, or simulated and stored there.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "scenes/simulation/frame_cache.h"
#include "scenes/simulation/simulation.h"

namespace crumple::scenes {

class SimulatedFrames {
   public:
    /// `key`: as for FrameCache; empty: nothing is cached on disk.
    SimulatedFrames(std::unique_ptr<Simulation> simulation, const std::string& key);

    /// Returns a frame. If frames are requested in ascending order, each is simulated once; a frame before the previous
    /// one restarts the simulation, unless it is cached. Calls `progress` with the index of each frame that has been
    /// simulated.
    io::TriangleMesh frame(int index, const std::function<void(int)>& progress);

   private:
    void go_to_start(int index);

    std::unique_ptr<Simulation> simulation_;
    std::optional<FrameCache> cache_;
    std::optional<ClothSolver> solver_;
    int at_ = 0;  ///< the solver's frame
};

}  // namespace crumple::scenes
