#pragma once

// Local mesh of one rank, if a mesh is distributed in blocks of triangles.

#include <cstdint>
#include <variant>
#include <vector>

#include "crumple/distributed.h"
#include "crumple/io.h"

namespace crumple::benchmark {

/// Block of consecutive triangles of a mesh, with their vertices. All blocks have about the same number of triangles.
struct RankBlock {
    io::TriangleMesh mesh;
    std::vector<std::int64_t> vertex_ids;

    RankBlock(const io::TriangleMesh& whole, int rank, int ranks) {
        const std::int64_t m = whole.triangle_count();
        std::vector<std::int32_t> local(static_cast<std::size_t>(whole.vertex_count()), -1);
        for (std::int64_t t = rank * m / ranks; t < (rank + 1) * m / ranks; ++t) {
            for (std::int64_t k = 3 * t; k < 3 * t + 3; ++k) {
                std::int32_t& v = local[static_cast<std::size_t>(whole.triangles[static_cast<std::size_t>(k)])];
                if (v < 0) {
                    v = static_cast<std::int32_t>(vertex_ids.size());
                    vertex_ids.push_back(whole.triangles[static_cast<std::size_t>(k)]);
                }
                mesh.triangles.push_back(v);
            }
        }
        // Rank 0 adds the vertices that are corners of no triangle of the whole mesh.
        for (std::size_t v = 0; rank == 0 && v < local.size(); ++v)
            if (local[v] < 0 && !named_elsewhere(whole, v)) vertex_ids.push_back(static_cast<std::int64_t>(v));
        follow(whole);
    }
    void follow(const io::TriangleMesh& whole) {
        std::visit(
            [&](const auto& all) {
                std::remove_cvref_t<decltype(all)> xyz;
                xyz.reserve(3 * vertex_ids.size());
                for (const std::int64_t v : vertex_ids)
                    for (std::int64_t i = 3 * v; i < 3 * v + 3; ++i) xyz.push_back(all[static_cast<std::size_t>(i)]);
                mesh.vertices = std::move(xyz);
            },
            whole.vertices);
    }
    /// Returns the block as the local mesh of its rank. Blocks are in the order of the ranks, so triangles need no ids.
    LocalMesh local_mesh() const { return {mesh.view(), {}, vertex_ids}; }

   private:
    bool named_elsewhere(const io::TriangleMesh& whole, std::size_t v) {
        if (named_.empty()) {
            named_.resize(static_cast<std::size_t>(whole.vertex_count()));
            for (const std::int32_t corner : whole.triangles) named_[static_cast<std::size_t>(corner)] = true;
        }
        return named_[v];
    }
    std::vector<bool> named_;
};

}  // namespace crumple::benchmark
