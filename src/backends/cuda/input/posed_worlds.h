#pragma once

// Bodies of all worlds on the device (backends/resting_worlds.h), where they stay; a call brings their poses, which lie
// there already. The first kernel of its pass puts the vertices where they are now:
//
//     shapes' vertices ──┐
//     bodies of the scene ──> pose: check, box ──> vertices, of the launch ──> the pass of worlds side by side
//     poses, the caller's ──┘                                                  corners, classes, worlds: stay

#include <cstdint>
#include <memory>
#include <vector>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/world_names.h"
#include "backends/cuda/stages/bounds.h"
#include "backends/cuda/stages/layout.h"
#include "backends/resting_worlds.h"
#include "crumple/world.h"
#include "scene/wanted_pairs.h"

namespace crumple::cuda {

class PosedWorlds {
   public:
    /// Done with the copies when it returns.
    PosedWorlds(std::unique_ptr<RestingWorlds> resting, cudaStream_t stream, MemoryMeter& meter);

    const RestingWorlds& resting() const { return *resting_; }

    /// The scene; its vertices are those that pose() has written for a launch.
    const PreparedScene& scene() const { return scene_; }
    std::size_t vertex_bytes() const;
    /// Each world's triangles, and a counter each for hits, if there are several; else null.
    const Segments& worlds() const { return worlds_; }
    unsigned long long* found() const { return found_; }
    const WantedPairs& wanted() const { return wanted_; }
    /// How an answer's triangles are named on the device.
    const WorldNames& names() const { return names_; }
    /// Differs from that of any other of this process.
    std::uint64_t number() const { return number_; }

    /// Writes the posed vertices, widens the box by them and notes the first that is not finite.
    void pose(const Geometry& geometry, cudaStream_t stream, const DevicePoses& poses, std::byte* vertices,
              SceneBox* box, Counters* counters) const;

    /// Throws the Error about a vertex that the counters note, if any.
    void throw_error(cudaStream_t stream, const DevicePoses& poses, const Counters& counters) const;

   private:
    std::unique_ptr<RestingWorlds> resting_;
    Block block_;
    PreparedScene scene_;
    Segments worlds_{};
    unsigned long long* found_ = nullptr;
    WantedPairs wanted_;
    WorldNames names_;
    std::byte* shapes_ = nullptr;
    RestingBody* bodies_ = nullptr;
    std::uint32_t* first_body_ = nullptr;  ///< of every pose_tile vertices
    std::uint64_t number_;
};

/// Poses of the device as the host has them.
std::vector<Pose> to_host(cudaStream_t stream, const DevicePoses& poses);

}  // namespace crumple::cuda
