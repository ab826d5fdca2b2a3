#include "cli/frames.h"

#include <utility>

#include "crumple/error.h"

namespace crumple::cli {

SequenceFrames::SequenceFrames(std::vector<std::string> files, const std::string& scene,
                               const scenes::Parameters& parameters)
    : files_(std::move(files)), scene_name_(scene) {
    if (scene.empty() == files_.empty()) {
        throw Error(ErrorCode::invalid_argument, "sequence needs either frames or a --scene", Element::option);
    }
    check_standard_input(files_);
    if (scene.empty()) return;
    scene_.emplace(scene, parameters);
    scene_frames_ = static_cast<std::size_t>(scene_->description().frames);
}

InputMeshes SequenceFrames::load(std::size_t i, const QueryOptions& options) {
    if (!scene_) {
        InputMeshes input = read_input({files_[i]}, options);
        unit_.apply(files_[i], input.first);
        return input;
    }
    return generated_input(scene_name_ + ", frame " + std::to_string(i), scene_->frame(static_cast<int>(i)), options);
}

}  // namespace crumple::cli
