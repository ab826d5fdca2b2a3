#pragma once

// One scene of all bodies of all worlds, without poses, for a device that has the poses and caches the scene between
// calls. Worlds lie side by side in the order of the result (world_scene.h). A body that is in all worlds occurs in
// each of them. Each occurrence of a body has vertex numbers of its own, at which the device writes its posed vertices,
// but shape_vertices() stores the unposed vertices of each shape only once.
//
//     triangles   | world 0: its bodies, then those in all worlds | world 1: ... | ... | only those in all worlds
//     vertices    | occurrence of a body | occurrence of a body | ...

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/intersections.h"
#include "crumple/world.h"
#include "scene/body_filter.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Occurrence of a body in the scene.
struct alignas(16) StaticBody {
    std::uint32_t first_vertex = 0;  ///< number of its first vertex in the scene
    std::uint32_t shape_vertex = 0;  ///< first vertex of its shape, in StaticWorlds::shape_vertices()
    std::int32_t body = 0;           ///< index in World::bodies
    std::uint32_t float32 = 1;       ///< 1 if its posed vertices are rounded to float32
};

class StaticWorlds {
   public:
    /// Reads shapes and bodies. Returns null if one scene cannot hold so many worlds, or so many triangles. Throws
    /// Error as Detector::find does for worlds.
    static std::unique_ptr<StaticWorlds> make(const World& world, const PairFilter& rules, int worlds_at_once,
                                              ParallelFor& workers, MemoryMeter& meter);
    ~StaticWorlds();

    /// Returns true if the world has the same bodies, whatever their poses, and the same pair filter. Compares groups,
    /// and the contents of unnamed shapes. Throws Error (invalid_argument) if a shape has the name of a cached one, but
    /// another size or precision.
    bool is_of(const World& world, const PairFilter& rules) const;

    /// Returns the scene. Its vertices are unposed; they, corners and groups are valid until drop_lists().
    const PreparedScene& scene() const { return scene_; }
    /// Vertices of all shapes, concatenated, in the scene's precision.
    const std::byte* shape_vertices() const { return shape_vertices_.data(); }
    std::size_t shape_bytes() const { return shape_vertices_.size(); }
    std::span<const StaticBody> bodies() const { return bodies_.span(); }
    /// True if no two triangles could meet.
    bool empty() const { return caller_worlds_.empty(); }
    const BodyFilter& rules() const { return body_filter_; }
    /// Returns, for each class of triangles (BodyFilter::classes), the first triangle in the scene of the body that the
    /// class belongs to.
    std::span<const std::int32_t> first_of_class() const { return first_of_class_.span(); }
    /// Number of the caller's worlds, and the first triangle in the scene of each; the last entry is the first triangle
    /// of the section in which bodies that are in all worlds meet each other.
    std::int32_t worlds() const;
    std::span<const std::int64_t> first_of_world() const { return first_of_caller_world_.span(); }

    /// Frees the lists that are needed only for the upload to a device.
    void drop_lists();

    /// Throws the Error for a posed vertex of the scene that is not finite. `poses`: those of all bodies.
    [[noreturn]] void fail_not_finite(std::int64_t vertex, std::span<const Pose> poses) const;

    /// Add the result of a search of the scene to a result about the caller's worlds and bodies: flags, one for each
    /// world of the scene, or all pairs.
    void report_flags(std::span<const std::uint8_t> flags, Intersections& result) const;
    void report_pairs(const Intersections& found, const IntersectionQuery& query, Intersections& result) const;
    /// begin() clears the result before a report, finish() completes it afterwards.
    void begin(const IntersectionQuery& query, Intersections& result) const;
    void finish(const IntersectionQuery& query, Intersections& result) const;

   private:
    struct Read;

    StaticWorlds(const World& world, const PairFilter& rules, MemoryMeter& meter);
    bool choose_worlds(int worlds_at_once);
    void add_shapes();
    void add_bodies(ParallelFor& workers);
    std::size_t added_of_triangle(std::int64_t t) const;

    MemoryMeter& meter_;
    std::vector<Shape> shapes_;  ///< the arrays that they view may no longer exist
    Array<Body> all_;            ///< the caller's bodies
    PairFilter given_;           ///< the caller's pair filter
    /// Contents of each shape that its name does not identify, as numbers: groups and, if it has no name, positions and
    /// triangles.
    std::vector<Array<std::uint64_t>> contents_;
    BodyFilter body_filter_;
    std::unique_ptr<Read> read_;
    PreparedScene scene_;
    Array<std::byte> shape_vertices_;
    std::vector<std::uint32_t> shape_first_;  ///< by shape: its first vertex in shape_vertices_
    Array<StaticBody> bodies_;
    Array<std::int64_t> first_of_occurrence_;  ///< first triangle of each of `bodies_`; and the end
    Array<std::int32_t> first_of_class_;
    /// First triangle of each of the caller's worlds; then that of the last section.
    Array<std::int64_t> first_of_caller_world_;
    Array<std::int64_t> first_of_scene_world_;  ///< first triangle of each world of the scene; and the end
    /// Caller's world for each world of the scene; worlds() for the last section.
    Array<std::int32_t> caller_worlds_;
};

}  // namespace crumple
