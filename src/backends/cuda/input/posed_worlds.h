#pragma once

// Bodies of all worlds, cached on the device (backends/static_worlds.h). A call passes only their poses, which also
// lie on the device. A kernel at the start of its pass computes the posed vertices:
//
//     shapes' vertices ─────┐
//     bodies of the scene ──┼─> pose: check, box ──> vertices of each launch ──> the pass of worlds side by side
//     the caller's poses ───┘                                                    corners, classes, worlds: cached

#include <cstdint>
#include <memory>
#include <vector>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/world_names.h"
#include "backends/cuda/stages/bounds.h"
#include "backends/cuda/stages/layout.h"
#include "backends/static_worlds.h"
#include "crumple/world.h"
#include "scene/pair_selection.h"

namespace crumple::cuda {

class PosedWorlds {
   public:
    /// Uploads the bodies, and returns once the copies are complete.
    PosedWorlds(std::unique_ptr<StaticWorlds> static_worlds, cudaStream_t stream, MemoryMeter& meter);

    const StaticWorlds& static_worlds() const { return *static_worlds_; }

    /// Returns the scene, without vertices: pose() writes those of each launch.
    const PreparedScene& scene() const { return scene_; }
    std::size_t vertex_bytes() const;
    /// Return each world's triangles, and a counter of hits for each; null for a single world.
    const Segments& worlds() const { return worlds_; }
    unsigned long long* found() const { return found_; }
    const PairSelection& wanted() const { return wanted_; }
    /// Returns the tables that translate triangles of the scene to triangles of bodies.
    const WorldNames& names() const { return names_; }
    /// Returns a number that is unique in this process.
    std::uint64_t number() const { return number_; }

    /// Writes the posed vertices, widens the box by them, and records in the counters the lowest one that is not
    /// finite.
    void pose(const Geometry& geometry, cudaStream_t stream, const DevicePoses& poses, std::byte* vertices,
              SceneBox* box, Counters* counters) const;

    /// Throws the Error about a vertex that the counters report, if any.
    void throw_error(cudaStream_t stream, const DevicePoses& poses, const Counters& counters) const;

   private:
    std::unique_ptr<StaticWorlds> static_worlds_;
    Block block_;
    PreparedScene scene_;
    Segments worlds_{};
    unsigned long long* found_ = nullptr;
    PairSelection wanted_;
    WorldNames names_;
    std::byte* shapes_ = nullptr;
    StaticBody* bodies_ = nullptr;
    std::uint32_t* first_body_ = nullptr;  ///< body of the first vertex of each tile of 256; and the last body
    std::uint64_t number_;
};

/// Downloads poses, and converts them to float64.
std::vector<Pose> to_host(cudaStream_t stream, const DevicePoses& poses);

}  // namespace crumple::cuda
