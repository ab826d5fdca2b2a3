#pragma once

// Frames of a sequence: one file each, or a procedural scene that is generated frame by frame.

#include <optional>
#include <string>
#include <vector>

#include "cli/printed_units.h"
#include "cli/search.h"
#include "scenes/scenes.h"

namespace crumple::cli {

class SequenceFrames {
   public:
    /// `files`: one per frame. `scene`: name of a procedural scene. Throws Error (invalid_argument) unless exactly one
    /// of the two is given.
    SequenceFrames(std::vector<std::string> files, const std::string& scene, const scenes::Parameters& parameters);

    std::size_t count() const { return files_.empty() ? scene_frames_ : files_.size(); }
    /// Returns the name of a frame: its file, or its number in the scene.
    std::string name(std::size_t i) const { return files_.empty() ? std::to_string(i) : files_[i]; }
    /// Loads frame i. Call in ascending order of i. Throws Error that names the file and the place in it.
    InputMeshes load(std::size_t i, const QueryOptions& options);

   private:
    std::vector<std::string> files_;
    std::string scene_name_;
    std::size_t scene_frames_ = 0;
    std::optional<scenes::Animation> scene_;
    io::CommonUnit unit_ = common_unit(false);
};

}  // namespace crumple::cli
