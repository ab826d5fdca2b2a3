#pragma once

// What a call is given, brought into the device's memory: a scene that the host has checked and joined, meshes that lie
// on the device already, which are checked, joined and welded there, or poses of bodies that lie there.

#include <memory>
#include <optional>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/device/mirror.h"
#include "backends/cuda/device/places.h"
#include "backends/cuda/input/known_mesh.h"
#include "backends/cuda/input/posed_worlds.h"
#include "backends/cuda/input/worlds_side_by_side.h"
#include "backends/cuda/stages/bounds.h"
#include "crumple/mesh.h"
#include "geometry/position_hash.h"
#include "scene/prepared_scene.h"
#include "scene/rules.h"

namespace crumple::cuda {

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

    /// A scene in host memory; done when it returns.
    void bring(const PreparedScene& host);
    /// One mesh or two in device memory. Throws Error (invalid_argument) for shapes that make no sense and for arrays
    /// that lie elsewhere; contents are checked by the work that enqueue() gives to the stream.
    void view(const MeshView& a, const MeshView* b, bool weld, Room room = Room::grows);
    /// One mesh in device memory whose features are asked about. Counts are as they are known; else Error, or what was
    /// seen of it is no use.
    void view(const Shape& shape, const KnownMesh& known, Room room = Room::grows);
    /// Bodies under poses in device memory, which enqueue()'s work reads. `pairs`: whether the answer on the device
    /// names pairs by bodies. Throws Error (invalid_argument) for poses that lie elsewhere.
    void pose(std::shared_ptr<const PosedWorlds> worlds, const DevicePoses& poses, bool weld, bool pairs,
              Room room = Room::grows);
    /// The query's rules, or those of the world that the scene is made of.
    void want(const IntersectionQuery& query, Room room = Room::grows);
    void want(const GroupRule& rule, Room room = Room::grows);

    /// What is to be cleared before enqueue()'s work.
    void clear(Clearing& clearing) const;
    /// Work that each pass begins with: meshes of the device are joined, welded and measured. Bad elements are noted by
    /// the counters.
    void enqueue(const Geometry& geometry, cudaStream_t stream, Counters* counters);

    /// Throws the Error that the counters tell of, if any, or MeshChanged.
    void throw_error(const Counters& counters) const;

    void release();

    /// What enqueue()'s work depends on beside the scene: while it is equal, so is the work.
    struct Work {
        TriangleView triangles[2];
        const void *groups[2] = {}, *lists[2] = {}, *block = nullptr, *poses = nullptr;
        KnownMesh known;
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
    const WantedPairs& wanted() const { return wanted_; }
    /// Null where the scene is no worlds under poses.
    const PosedWorlds* posed() const { return posed_.get(); }
    const WorldNames& names() const { return names_; }

   private:
    void join(const Geometry& geometry, cudaStream_t stream, Counters* counters);
    void pose(const Geometry& geometry, cudaStream_t stream, Counters* counters);
    void weld(const Geometry& geometry, cudaStream_t stream);
    void forget();

    Places places_;
    cudaStream_t stream_;
    Block block_;
    Worlds worlds_;
    GroupRule rule_;
    Mirror<std::uint64_t> excluded_groups_, excluded_bodies_;
    Mirror<BodyClass> classes_;
    Array<std::byte> packed_;
    PreparedScene scene_;
    std::optional<MeshView> mesh_[2];   ///< on the device; none: the host has checked and joined
    std::optional<Shape> known_shape_;  ///< or one whose features are known
    KnownMesh known_;
    std::shared_ptr<const PosedWorlds> posed_;  ///< or bodies, under
    DevicePoses poses_;
    WorldNames names_;
    std::byte* vertices_ = nullptr;  ///< of these
    bool weld_ = false;
    PositionHash hash_;
    SceneBox* box_ = nullptr;
    std::int32_t *corners_ = nullptr, *groups_ = nullptr;
    unsigned* table_ = nullptr;  ///< of welding
    std::size_t slots_ = 0;
    WantedPairs wanted_;  ///< on the device
};

}  // namespace crumple::cuda
