#pragma once

// Input of a call in device memory: a scene that the host has validated and joined, meshes on the device, which are
// validated, joined and welded there, or bodies under poses on the device.

#include <memory>
#include <optional>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/device/mirror.h"
#include "backends/cuda/device/places.h"
#include "backends/cuda/input/cached_mesh.h"
#include "backends/cuda/input/posed_worlds.h"
#include "backends/cuda/input/worlds_side_by_side.h"
#include "backends/cuda/stages/bounds.h"
#include "crumple/mesh.h"
#include "geometry/position_hash.h"
#include "scene/prepared_scene.h"
#include "scene/scene_filter.h"

namespace crumple::cuda {

/// Binds the input of one call at a time: a new input replaces the previous one.
class Input {
   public:
    Input(int device, cudaStream_t stream, MemoryMeter& meter)
        : places_(device),
          stream_(stream),
          block_(meter),
          worlds_(meter),
          rule_(&meter),
          excluded_groups_(meter),
          excluded_bodies_(meter),
          classes_(meter),
          packed_(&meter) {}

    /// Uploads a scene from host memory, and returns once the copies are complete.
    void bring(const PreparedScene& host);
    /// Binds one or two meshes in device memory. `weld`: vertices at equal positions become one. Throws Error
    /// (invalid_argument) for invalid counts, pointers or groups and for arrays that the device cannot read; the work
    /// of enqueue() validates the contents.
    void view(const MeshView& a, const MeshView* b, bool weld, Growth growth = Growth::grows);
    /// Binds a mesh in device memory for a feature query. Its counts of triangles, edges and points must match the
    /// cached mesh; the work of enqueue() compares the contents.
    void view(const Shape& shape, const CachedMesh& known, Growth growth = Growth::grows);
    /// Binds bodies under poses in device memory, which the work of enqueue() reads. `pairs`: true if the result on the
    /// device names pairs by bodies. Throws Error (invalid_argument) for poses that the device cannot read.
    void pose(std::shared_ptr<const PosedWorlds> worlds, const DevicePoses& poses, bool weld, bool pairs,
              Growth growth = Growth::grows);
    /// Sets the pair filter: for bodies under poses that of their world, else the query's.
    void want(const IntersectionQuery& query, Growth growth = Growth::grows);
    /// Sets an already prepared pair filter, that of a request about features.
    void want(const SceneFilter& rule, Growth growth = Growth::grows);

    /// Adds the arrays that the work of enqueue() requires cleared to `batch`.
    void clear(BatchedClear& batch) const;
    /// Enqueues the work that each pass begins with, for inputs on the device: validates, joins and welds meshes,
    /// compares a mesh with the cached one, or poses bodies; and finds the box. Records invalid or changed elements in
    /// the counters.
    void enqueue(const Geometry& geometry, cudaStream_t stream, Counters* counters);

    /// Throws the Error that the counters report, if any, or MeshChanged.
    void throw_error(const Counters& counters) const;

    void release();

    /// All that the work of enqueue() depends on besides the scene: equal values mean equal work.
    struct Work {
        TriangleView triangles[2];
        const void *groups[2] = {}, *lists[2] = {}, *block = nullptr, *poses = nullptr;
        CachedMesh known;
        bool weld = false;
        ScalarType type_of_poses{};
        std::uint64_t bodies = 0;  ///< PosedWorlds::number()
        WorldNames names;
        friend bool operator==(const Work&, const Work&) = default;
    };
    Work work() const;

    const PreparedScene& scene() const { return scene_; }
    const SceneBox* box() const { return box_; }
    const Worlds& worlds() const { return worlds_; }
    const PairSelection& wanted() const { return wanted_; }
    /// Returns the bodies; null unless the scene is made of bodies under poses on the device.
    const PosedWorlds* posed() const { return posed_.get(); }
    const WorldNames& names() const { return names_; }

   private:
    void join(const Geometry& geometry, cudaStream_t stream, Counters* counters);
    void pose(const Geometry& geometry, cudaStream_t stream, Counters* counters);
    void weld(const Geometry& geometry, cudaStream_t stream);
    void forget();

    ReadableArrays places_;
    cudaStream_t stream_;
    Block block_;
    Worlds worlds_;
    SceneFilter rule_;
    Mirror<std::uint64_t> excluded_groups_, excluded_bodies_;
    Mirror<BodyClass> classes_;
    Array<std::byte> packed_;
    PreparedScene scene_;
    std::optional<MeshView> mesh_[2];           ///< meshes on the device, for queries about intersections; else none
    std::optional<Shape> cached_shape_;         ///< mesh on the device whose features are cached; else none
    CachedMesh known_;                          ///< features of cached_shape_
    std::shared_ptr<const PosedWorlds> posed_;  ///< bodies under poses_; else null
    DevicePoses poses_;
    WorldNames names_;
    std::byte* vertices_ = nullptr;  ///< posed vertices
    bool weld_ = false;
    PositionHash hash_;
    SceneBox* box_ = nullptr;
    std::int32_t *corners_ = nullptr, *groups_ = nullptr;
    unsigned* table_ = nullptr;  ///< hash table for welding
    std::size_t slots_ = 0;
    PairSelection wanted_;  ///< pair filter, with lists on the device
};

}  // namespace crumple::cuda
