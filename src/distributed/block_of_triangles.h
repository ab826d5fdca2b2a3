#pragma once

// A block of a scene's triangles, as the local mesh of rank r. The ranks are threads of the process that has the scene
// of m triangles.
//
//     triangles   [r m / ranks, (r + 1) m / ranks), both bounds rounded down
//     vertices    the vertices of these triangles, and the r-th block of all vertices, so that each is on some rank

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "crumple/distributed.h"
#include "scene/prepared_scene.h"

namespace crumple::distribute {

class TriangleBlock {
   public:
    TriangleBlock(int rank, int ranks) : rank_(rank), ranks_(ranks) {}

    /// Returns the local mesh; valid until the next call. Copies the coordinates; renumbers the vertices if the scene's
    /// triangles have changed.
    LocalMesh take(const PreparedScene& scene);
    /// Returns the end positions of the local mesh, if the scene of the last take() moves.
    VertexView end() const { return view_of(end_); }

   private:
    using Coordinates = std::variant<std::vector<float>, std::vector<double>>;
    struct Range {
        std::int64_t begin, end;
        std::int64_t size() const { return end - begin; }
        friend bool operator==(const Range&, const Range&) = default;
    };
    Range mine(std::int64_t all) const { return {rank_ * all / ranks_, (rank_ + 1) * all / ranks_}; }
    std::span<const std::int32_t> corners_in(const PreparedScene& scene) const;
    bool names_the_same(const PreparedScene& scene) const;
    void number(const PreparedScene& scene);
    void gather(const VertexReader& reader, Coordinates& xyz) const;
    template <class Scalar>
    void gather_as(const VertexReader& reader, Coordinates& xyz) const;
    static VertexView view_of(const Coordinates& xyz);

    int rank_, ranks_;
    Range triangles_{0, 0}, vertices_{0, 0};
    std::vector<std::int32_t> corners_;  ///< 3 per triangle, indices into ids_
    std::vector<std::int64_t> ids_;      ///< index in the scene of each local vertex; this rank's block comes first
    Coordinates start_, end_;
};

}  // namespace crumple::distribute
