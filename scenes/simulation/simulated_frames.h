#pragma once

// The frames of a simulation, from the cache where they are there, else simulated and put there.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "scenes/simulation/frame_cache.h"
#include "scenes/simulation/simulation.h"

namespace crumple::scenes {

class SimulatedFrames {
   public:
    /// `key` as for FrameCache; empty: nothing is kept on disk.
    SimulatedFrames(std::unique_ptr<Simulation> simulation, const std::string& key);

    /// Frames in ascending order are simulated once each; one before the last begins anew, unless it is in the cache.
    /// `progress` is told each frame that has been simulated on the way.
    io::TriangleMesh frame(int index, const std::function<void(int)>& progress);

   private:
    void go_to_start(int index);

    std::unique_ptr<Simulation> simulation_;
    std::optional<FrameCache> cache_;
    std::optional<ClothSolver> solver_;
    int at_ = 0;  ///< the solver's frame
};

}  // namespace crumple::scenes
