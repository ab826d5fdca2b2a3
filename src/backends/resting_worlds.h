#pragma once

// All bodies of all worlds as one scene in which nobody is posed yet, for a device that has the poses and keeps the
// rest from call to call. Worlds lie side by side in the order of the answer (world_scene.h); each shape's vertices are
// there once, whoever has that shape.
//
//     triangles   | world 0: its bodies, those in all worlds | world 1: ... | ... | those in all worlds, among
//     themselves vertices    | body | body | ...     each a copy of its shape's, under its pose

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/intersections.h"
#include "crumple/world.h"
#include "scene/body_rules.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// A body, as often as the scene has it.
struct alignas(16) RestingBody {
    std::uint32_t first_vertex = 0;  ///< in the scene
    std::uint32_t shape_vertex = 0;  ///< first of its shape, among those of all shapes
    std::int32_t body = 0;
    std::uint32_t float32 = 1;  ///< whether its posed vertices are rounded to float32
};

class RestingWorlds {
   public:
    /// Reads all. Null if one scene cannot hold so many worlds, or so many triangles. Throws Error as
    /// Detector::find(World) does.
    static std::unique_ptr<RestingWorlds> make(const World& world, const PairFilter& rules, int worlds_at_once,
                                               ParallelFor& workers, MemoryMeter& meter);
    ~RestingWorlds();

    /// Whether these are the world's bodies, whatever their poses, under the same rules. Reads the contents of shapes
    /// without a name, and groups. Throws Error (invalid_argument) for a known name with another size.
    bool is_of(const World& world, const PairFilter& rules) const;

    /// The scene, without vertices. Its corners and groups are there until drop_lists().
    const PreparedScene& scene() const { return scene_; }
    /// Vertices of all shapes, one behind the other, in the scene's precision.
    const std::byte* shape_vertices() const { return shape_vertices_.data(); }
    std::size_t shape_bytes() const { return shape_vertices_.size(); }
    std::span<const RestingBody> bodies() const { return bodies_.span(); }
    /// There are no two triangles that could meet.
    bool empty() const { return passes_.empty(); }
    const BodyRules& rules() const { return rules_; }
    /// By class: the first triangle, in the scene, of its body.
    std::span<const std::int32_t> first_of_class() const { return first_of_class_.span(); }
    /// How many worlds the caller has, and by world the first triangle, in the scene; in the end where bodies that are
    /// in all worlds lie among themselves.
    std::int32_t worlds() const;
    std::span<const std::int64_t> first_of_world() const { return first_of_world_.span(); }

    /// Forgets what is needed once, to bring it to a device.
    void drop_lists();

    /// Throws the Error about a posed vertex of the scene that is not finite; `poses`: of all bodies.
    [[noreturn]] void fail_not_finite(std::int64_t vertex, std::span<const Pose> poses) const;

    /// The answer of the host, from the scene's: by flags, one a world of the scene, or by all pairs.
    void tell_flags(std::span<const std::uint8_t> flags, Intersections& result) const;
    void tell_pairs(const Intersections& found, const IntersectionQuery& question, Intersections& result) const;
    /// What an answer begins and ends with.
    void begin(const IntersectionQuery& question, Intersections& result) const;
    void finish(const IntersectionQuery& question, Intersections& result) const;

   private:
    struct Read;

    RestingWorlds(const World& world, const PairFilter& rules, MemoryMeter& meter);
    bool choose_passes(int worlds_at_once);
    void add_shapes();
    void add_bodies(ParallelFor& workers);
    std::size_t added_of_triangle(std::int64_t t) const;

    MemoryMeter& meter_;
    std::vector<Shape> shapes_;  ///< their arrays may be gone
    Array<Body> all_;
    PairFilter given_;
    std::vector<Array<std::uint64_t>> contents_;  ///< of shapes, what a name says nothing of
    BodyRules rules_;
    std::unique_ptr<Read> read_;
    PreparedScene scene_;
    Array<std::byte> shape_vertices_;
    std::vector<std::uint32_t> shape_first_;
    Array<RestingBody> bodies_;
    Array<std::int64_t> first_of_added_;  ///< triangles of `bodies_`, and of all
    Array<std::int32_t> first_of_class_;
    Array<std::int64_t> first_of_world_;   ///< of the caller
    Array<std::int64_t> first_of_joined_;  ///< of the scene
    Array<std::int32_t> passes_;           ///< by world of the scene
};

}  // namespace crumple
