#pragma once

// Disk cache of simulated frames: one folder for each scene with its parameters, under $XDG_CACHE_HOME/crumple or
// ~/.cache/crumple. A frame is a file of its points in float32. One more file has the state in float64 of the last
// frame that was simulated; a simulation resumes from there. Files appear whole or not at all and carry a checksum, so
// an interrupted run leaves valid frames. Files that are missing, damaged or of another version are ignored, and frames
// that cannot be written are not cached: the cache saves time and changes no result.

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

    /// Returns the frame's points, 3 coordinates each, or nothing if it is not cached.
    std::optional<std::vector<float>> points(int frame) const;
    std::optional<State> last_state() const;

    void store(int frame, std::span<const float> points, const ClothSolver& solver) const;

   private:
    std::filesystem::path folder_;  ///< empty if neither XDG_CACHE_HOME nor HOME is usable: nothing is cached
};

}  // namespace crumple::scenes
