#pragma once

// Frames of a sequence: files, or a scene that is made frame by frame.

#include <optional>
#include <string>
#include <vector>

#include "cli/common_unit.h"
#include "cli/search.h"
#include "scenes/scenes.h"

namespace crumple::cli {

class Frames {
   public:
    /// Takes files, or, if `scene` is not empty, that scene. Throws Error (invalid_argument) for both or neither.
    Frames(std::vector<std::string> files, const std::string& scene, const scenes::Parameters& parameters);

    std::size_t count() const { return files_.empty() ? scene_frames_ : files_.size(); }
    /// Returns the name of the file, or the number of the scene's frame.
    std::string name(std::size_t i) const { return files_.empty() ? std::to_string(i) : files_[i]; }
    /// Loads a frame; must be called in ascending order. Throws Error that names the file and the place.
    Input load(std::size_t i, const QueryOptions& options);

   private:
    std::vector<std::string> files_;
    std::string scene_name_;
    std::size_t scene_frames_ = 0;
    std::optional<scenes::Animation> scene_;
    CommonUnit unit_{false};
};

}  // namespace crumple::cli
