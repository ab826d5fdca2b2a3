#pragma once

#include <span>
#include <vector>

#include "backends/backend.h"
#include "crumple/world.h"
#include "queries/checks.h"

namespace crumple {

/// World with poses in host memory: downloads poses that are in device memory.
class PosedOnHost {
   public:
    PosedOnHost(BackendBase& backend, const World& world) : world_(world) {
        if (!lies_on_device(world)) return;
        check_device_poses(world);
        const auto copy = [&](DevicePoses& there, std::vector<Pose>& here, std::span<const Pose>& poses) {
            if (!given(there)) return;
            here = backend.poses_of(there);
            poses = here;
            there = {};
        };
        copy(world_.device_poses, poses_, world_.poses);
        copy(world_.device_end_poses, end_poses_, world_.end_poses);
    }
    PosedOnHost(const PosedOnHost&) = delete;
    PosedOnHost& operator=(const PosedOnHost&) = delete;
    const World& world() const { return world_; }

   private:
    World world_;
    std::vector<Pose> poses_, end_poses_;
};

}  // namespace crumple
