#pragma once

// Frames that have been simulated, on disk: one folder a scene with its parameters, under $XDG_CACHE_HOME/crumple or
// ~/.cache/crumple.
//
// A frame is a file of its points in float32; one more file has the state, in float64, of the frame that a simulation
// reached last, to go on from. Files appear whole or not at all and carry a checksum, so an interrupted run leaves what
// it has. What is missing, damaged or of another version is as good as not there, and what cannot be written is not
// kept: a cache saves time and changes nothing.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenes/simulation/cloth_solver.h"

namespace crumple::scenes {

class FrameCache {
   public:
    struct State {
        int frame;
        std::vector<Vec3d> points, velocities;
    };

    /// `key` names the scene and all its parameters, and is a file name.
    explicit FrameCache(const std::string& key);

    /// The frame's points, 3 coordinates each.
    std::optional<std::vector<float>> points(int frame) const;
    std::optional<State> last_state() const;

    void store(int frame, std::span<const float> points, const ClothSolver& solver) const;

   private:
    std::filesystem::path folder_;  ///< empty: there is no place to keep anything
};

}  // namespace crumple::scenes
