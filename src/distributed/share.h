#pragma once

// What one rank brings, checked, and the numbers that its triangles and vertices have over all ranks.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/distributed.h"
#include "scene/prepared_scene.h"

namespace crumple::distribute {

inline constexpr std::int64_t most_ids = std::numeric_limits<std::int32_t>::max();  ///< over all ranks

/// Numbers over all ranks: those that the caller has given, or the ranks' own behind each other.
struct Ids {
    std::span<const std::int64_t> given;
    std::int64_t first = 0;  ///< of this rank, where none are given
    std::int64_t all = 0;    ///< over all ranks

    bool are_given() const { return given.data() != nullptr; }
    std::int32_t operator()(std::int64_t i) const {
        return static_cast<std::int32_t>(are_given() ? given[static_cast<std::size_t>(i)] : first + i);
    }
};

class Share {
   public:
    explicit Share(MemoryMeter* meter) : buffers_(meter) {}

    /// The shapes of the arrays, for a start. Throws Error (invalid_argument).
    static void check_shape(const MeshShare& share);

    /// `counts`: triangles and vertices of each rank, two numbers a rank. Throws Error (invalid_argument) where all
    /// together are too many.
    void number(const MeshShare& share, bool triangle_ids, bool vertex_ids, std::span<const std::int64_t> counts,
                int rank);
    /// Checks vertices, triangles and ids on the threads of `workers`. Throws Error with the index over all ranks of
    /// the first that is bad in this rank's order.
    void read(const MeshShare& share, ParallelFor& workers);
    /// The same of where the vertices are at the end of a step. After read().
    void read_end(const VertexView& end, ParallelFor& workers);
    /// Over all ranks there are so many vertices, where ids are given.
    void set_vertices(std::int64_t all) { vertices_.all = all; }

    const PreparedScene& scene() const { return scene_; }
    const Ids& triangles() const { return triangles_; }
    const Ids& vertices() const { return vertices_; }

    /// Whether triangles, groups and ids are those of the call before; these are compared with in the next. By 128
    /// bits: that others pass for the same is less likely than that the memory errs.
    bool is_same_as_before();
    void forget();

   private:
    /// Has read() do what throws an Error about this rank's elements, and throws it about those of all ranks.
    template <class Read>
    void with_global_index(Read read) const;

    SceneBuffers buffers_;
    PreparedScene scene_;
    Ids triangles_, vertices_;
    /// Of the call before: counts, and a fingerprint of the arrays in place of copies, which would be a third of what a
    /// rank keeps.
    struct Kept {
        std::array<std::uint64_t, 2> fingerprint{};
        std::int64_t first_triangle = 0, first_vertex = 0, triangles = -1, vertices = 0;
        std::int64_t own_triangles = 0, own_vertices = 0;
        bool float32 = true, groups = false, triangle_ids = false, vertex_ids = false;
        bool operator==(const Kept&) const = default;
    } kept_;
};

}  // namespace crumple::distribute
