#pragma once

// Checked local mesh of a rank, and the numbers of its triangles and vertices over all ranks.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/distributed.h"
#include "scene/prepared_scene.h"

namespace crumple::distribute {

/// Largest supported number of triangles, and of vertices, of all ranks together.
inline constexpr std::int64_t most_ids = std::numeric_limits<std::int32_t>::max();

/// Numbers over all ranks of a rank's triangles or vertices: given by the caller, or consecutive, rank by rank.
struct Ids {
    std::span<const std::int64_t> given;
    std::int64_t first = 0;  ///< first number of this rank, if none are given
    std::int64_t all = 0;    ///< number of elements over all ranks

    bool are_given() const { return given.data() != nullptr; }
    std::int32_t operator()(std::int64_t i) const {
        return static_cast<std::int32_t>(are_given() ? given[static_cast<std::size_t>(i)] : first + i);
    }
};

class RankMesh {
   public:
    explicit RankMesh(MemoryMeter* meter) : buffers_(meter) {}

    /// Checks the sizes of the arrays. Throws Error (invalid_argument).
    static void check_shape(const LocalMesh& local);

    /// Numbers triangles and vertices over all ranks. `counts`: numbers of triangles and vertices, 2 per rank. Throws
    /// Error (invalid_argument) if there are too many over all ranks, or ids are given on other ranks only.
    void number(const LocalMesh& local, bool triangle_ids, bool vertex_ids, std::span<const std::int64_t> counts,
                int rank);
    /// Checks vertices, triangles and ids on the threads of `workers`. Throws Error with the number over all ranks of
    /// the first bad element in local order, or the least bad id.
    void read(const LocalMesh& local, ParallelFor& workers);
    /// Reads and checks the end positions of a step. Call after read().
    void read_end(const VertexView& end, ParallelFor& workers);
    /// Sets the number of vertices over all ranks, if ids are given.
    void set_vertices(std::int64_t all) { vertices_.all = all; }

    const PreparedScene& scene() const { return scene_; }
    const Ids& triangles() const { return triangles_; }
    const Ids& vertices() const { return vertices_; }

    /// True if triangles, groups and ids are those of the previous call, according to a 128-bit hash, whose collisions
    /// are less likely than hardware errors of the memory. Stores the hash for the next call.
    bool is_same_as_before();
    void forget();

   private:
    /// Runs read(), and converts local indices in its errors to numbers over all ranks.
    template <class Read>
    void with_global_index(Read read) const;

    SceneBuffers buffers_;
    PreparedScene scene_;
    Ids triangles_, vertices_;
    /// Input of the previous call: counts, and a hash of the arrays. Copies would be a third of a rank's memory.
    struct Kept {
        std::array<std::uint64_t, 2> fingerprint{};
        std::int64_t first_triangle = 0, first_vertex = 0, triangles = -1, vertices = 0;
        std::int64_t own_triangles = 0, own_vertices = 0;
        bool float32 = true, groups = false, triangle_ids = false, vertex_ids = false;
        bool operator==(const Kept&) const = default;
    } kept_;
};

}  // namespace crumple::distribute
