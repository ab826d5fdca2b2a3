#include "backends/cuda/intersections/posed_world_calls.h"

#include <utility>
#include <vector>

#include "results/intersection_output.h"

namespace crumple::cuda {

PosedWorldCalls::PosedWorldCalls(IntersectionFinder& finder, cudaStream_t stream, MemoryMeter& meter)
    : finder_(finder), stream_(stream), meter_(meter), found_(metered(&meter)) {}

void PosedWorldCalls::release() {
    known_.reset();
    found_ = metered(&meter_);
}

// Launches in flight share ownership of the bodies that they were given.
std::shared_ptr<const PosedWorlds> PosedWorldCalls::bodies_of(const World& world, const PairFilter& rules,
                                                              ParallelFor& workers, Room room) {
    if (known_ && known_->resting().is_of(world, rules)) return known_;
    if (room == Room::fixed) throw NoRoom{};
    known_.reset();
    std::unique_ptr<RestingWorlds> resting = RestingWorlds::make(world, rules, max_leaves, workers, meter_);
    if (resting) known_ = std::make_shared<const PosedWorlds>(std::move(resting), stream_, meter_);
    return known_;
}

bool PosedWorldCalls::find(const World& world, const IntersectionQuery& question, ParallelFor& workers,
                           Intersections& result) {
    const std::shared_ptr<const PosedWorlds> worlds = bodies_of(world, question.filter, workers);
    if (!worlds) return false;
    const RestingWorlds& resting = worlds->resting();
    resting.begin(question, result);
    finder_.pose(finder_.current(), worlds, world.device_poses, question.weld, false);
    finder_.adopt(question);
    if (question.output <= Output::any_by_world) {
        find_flags(*worlds, question.output, result);
    } else {
        finder_.find();
        finder_.copy_to(found_);
        resting.tell_pairs(found_, question, result);
    }
    add_pass(finder_.statistics(), result.statistics);
    resting.finish(question, result);
    return true;
}

void PosedWorldCalls::find_flags(const PosedWorlds& worlds, Output wants, Intersections& result) {
    const auto several = static_cast<std::size_t>(worlds.scene().worlds);
    std::vector<std::uint8_t> flags(worlds.resting().empty() ? 0 : several, 0);
    if (flags.empty()) return;
    if (wants == Output::any || several == 1) {
        flags[0] = finder_.any();
    } else {
        fill(stream_, worlds.found(), 0, several * sizeof *worlds.found());
        finder_.flag_worlds(flags);
    }
    worlds.resting().tell_flags(flags, result);
}

}  // namespace crumple::cuda
