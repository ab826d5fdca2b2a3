#pragma once

// What each rank brings: a block of the file's triangles, with the vertices that they name.

#include <cstdint>
#include <string>
#include <vector>

#include "cli/options.h"
#include "cli/rank_link.h"
#include "crumple/distributed.h"
#include "crumple/io.h"
#include "io/slice.h"

namespace crumple::cli {

struct RankInput {
    io::TriangleMesh mesh;                 ///< corners count in its vertices
    std::vector<std::int64_t> vertex_ids;  ///< over all ranks; empty where each triangle has its own
    io::Blocks triangles;                  ///< of all ranks
    bool weld = false;                     ///< vertices at equal positions are to be one

    MeshShare share() const { return {.mesh = mesh.view(), .triangle_ids = {}, .vertex_ids = vertex_ids}; }
};

/// Collective. Each rank reads its rows, where the file is binary PLY of triangles or binary STL; else, and from
/// standard input, rank 0 reads all and hands them out. Throws the same Error on all ranks.
RankInput read_on_ranks(RankLink& link, const std::string& file, const AnswerOptions& answer);

}  // namespace crumple::cli
