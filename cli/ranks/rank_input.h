#pragma once

// What each rank brings: a block of the file's triangles, with the vertices that they name.

#include <cstdint>
#include <string>
#include <vector>

#include "cli/command_options.h"
#include "cli/ranks/rank_link.h"
#include "crumple/distributed.h"
#include "crumple/io.h"
#include "io/bytes/slice.h"

namespace crumple::cli {

struct RankInput {
    io::TriangleMesh mesh;                 ///< corners count in its vertices
    io::TriangleMesh end;                  ///< of a step: the same vertices at its end
    std::vector<std::int64_t> vertex_ids;  ///< over all ranks; empty where each triangle has its own
    io::Blocks triangles;                  ///< of all ranks
    bool weld = false;                     ///< vertices at equal positions are to be one

    MeshShare share() const { return {.mesh = mesh.view(), .triangle_ids = {}, .vertex_ids = vertex_ids}; }
};

/// Collective. Each rank reads its rows, where the file is binary PLY of triangles or binary STL; else, and from
/// standard input, rank 0 reads all and hands them out. Throws the same Error on all ranks.
RankInput read_on_ranks(RankLink& link, const std::string& file, const AnswerOptions& answer);

/// The same for an answer that names vertices: where equal ones are to become one as they are read, rank 0 reads all.
/// Refuses lines and points.
RankInput read_features_on_ranks(RankLink& link, const std::string& file, const AnswerOptions& answer);

/// The same of a mesh at two times, as read_moving_input reads it.
RankInput read_step_on_ranks(RankLink& link, const std::string& start, const std::string& end,
                             const AnswerOptions& answer);

}  // namespace crumple::cli
