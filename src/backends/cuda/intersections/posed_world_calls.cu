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
                                                              ParallelFor& workers, Growth growth) {
    if (known_ && known_->static_worlds().is_of(world, rules)) return known_;
    if (growth == Growth::fixed) throw CapacityError{};
    known_.reset();
    std::unique_ptr<StaticWorlds> static_worlds = StaticWorlds::make(world, rules, max_leaves, workers, meter_);
    if (static_worlds) known_ = std::make_shared<const PosedWorlds>(std::move(static_worlds), stream_, meter_);
    return known_;
}

bool PosedWorldCalls::find(const World& world, const IntersectionQuery& query, ParallelFor& workers,
                           Intersections& result) {
    const std::shared_ptr<const PosedWorlds> worlds = bodies_of(world, query.filter, workers);
    if (!worlds) return false;
    const StaticWorlds& static_worlds = worlds->static_worlds();
    static_worlds.begin(query, result);
    finder_.pose(finder_.current(), worlds, world.device_poses, query.weld, false);
    finder_.copy_from(query);
    if (query.output <= Output::any_by_world) {
        find_flags(*worlds, query.output, result);
    } else {
        finder_.find();
        finder_.copy_to(found_);
        static_worlds.report_pairs(found_, query, result);
    }
    add_pass(finder_.statistics(), result.statistics);
    static_worlds.finish(query, result);
    return true;
}

void PosedWorldCalls::find_flags(const PosedWorlds& worlds, Output wants, Intersections& result) {
    const auto several = static_cast<std::size_t>(worlds.scene().worlds);
    std::vector<std::uint8_t> flags(worlds.static_worlds().empty() ? 0 : several, 0);
    if (flags.empty()) return;
    if (wants == Output::any || several == 1) {
        flags[0] = finder_.any();
    } else {
        fill(stream_, worlds.found(), 0, several * sizeof *worlds.found());
        finder_.flag_worlds(flags);
    }
    worlds.static_worlds().report_flags(flags, result);
}

}  // namespace crumple::cuda
