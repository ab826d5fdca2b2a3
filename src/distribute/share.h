#pragma once

// What one rank brings, checked, and the numbers that its triangles and vertices have over all ranks.

#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/distributed.h"
#include "model/scene.h"

namespace crumple::distribute {

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
    /// the first that is bad, as their numbers go.
    void read(const MeshShare& share, ParallelFor& workers);
    /// Over all ranks there are so many vertices, where ids are given.
    void set_vertices(std::int64_t all) { vertices_.all = all; }

    const Scene& scene() const { return scene_; }
    const Ids& triangles() const { return triangles_; }
    const Ids& vertices() const { return vertices_; }

    /// Whether triangles, groups and ids are those of the call before, whose copies are kept; they become these.
    bool is_same_as_before();
    void forget();

   private:
    SceneBuffers buffers_;
    Scene scene_;
    Ids triangles_, vertices_;
    struct Kept {
        std::vector<std::int32_t> corners, groups;
        std::vector<std::int64_t> triangle_ids, vertex_ids;
        std::int64_t first_triangle = 0, first_vertex = 0, triangles = -1, vertices = 0;
        bool float32 = true;
        bool operator==(const Kept&) const = default;
    } kept_;
};

}  // namespace crumple::distribute
