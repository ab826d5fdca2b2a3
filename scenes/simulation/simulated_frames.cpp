#include "scenes/simulation/simulated_frames.h"

namespace crumple::scenes {
namespace {

std::vector<float> rounded(const std::vector<Vec3d>& points) {
    std::vector<float> result;
    result.reserve(3 * points.size());
    for (const Vec3d p : points) {
        for (int k = 0; k < 3; ++k) result.push_back(static_cast<float>(p[k]));
    }
    return result;
}

}  // namespace

SimulatedFrames::SimulatedFrames(std::unique_ptr<Simulation> simulation, const std::string& key)
    : simulation_(std::move(simulation)) {
    if (!key.empty()) cache_.emplace(key);
}

void SimulatedFrames::go_to_start(int index) {
    if (solver_ && at_ <= index) return;
    solver_.emplace(simulation_->begin());
    at_ = 0;
    if (!cache_) return;
    const auto state = cache_->last_state();
    if (!state || state->frame <= 0 || state->frame > index) return;
    const Fabric fabric = simulation_->fabric(state->frame);
    if (fabric.flat.size() != state->points.size()) return;
    solver_->set_fabric(fabric);
    solver_->points = state->points;
    solver_->velocities = state->velocities;
    at_ = state->frame;
}

io::TriangleMesh SimulatedFrames::frame(int index, const std::function<void(int)>& progress) {
    if (cache_) {
        if (const auto points = cache_->points(index)) return simulation_->mesh(index, *points);
    }
    go_to_start(index);
    while (at_ < index) {
        simulation_->advance(*solver_, ++at_);
        if (cache_) cache_->store(at_, rounded(solver_->points), *solver_);
        if (progress) progress(at_);
    }
    return simulation_->mesh(index, rounded(solver_->points));
}

}  // namespace crumple::scenes
