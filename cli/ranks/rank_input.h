#pragma once

// Local mesh of each rank (MPI process): a block of the file's triangles, with their vertices.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_options.h"
#include "cli/ranks/rank_link.h"
#include "crumple/distributed.h"
#include "crumple/io.h"
#include "io/bytes/slice.h"

namespace crumple::cli {

struct RankInput {
    io::TriangleMesh mesh;                 ///< local mesh; corners are indices of its own vertices
    std::optional<io::TriangleMesh> end;   ///< for a step: the same vertices at the end of the step
    std::vector<std::int64_t> vertex_ids;  ///< index in the file of each local vertex, ascending
    bool has_copies = false;               ///< true if any rank has vertices of another rank's block
    io::Blocks triangles;                  ///< division of the file's triangles into a block for each rank
    bool weld = false;                     ///< true if the search has to weld vertices at equal positions

    LocalMesh local_mesh() const;
};

/// Collective. Reads a mesh or, for two files, one mesh at the start and at the end of a step. Each rank reads its own
/// rows of files that are binary PLY of triangles or binary STL. Rank 0 reads and distributes other files and standard
/// input. If `for_features`, rank 0 also reads files whose vertices are welded on reading, because results of features
/// contain ids of welded vertices. Throws the same Error on all ranks. Lines and points are errors.
RankInput read_on_ranks(RankLink& link, const std::vector<std::string>& files, const QueryOptions& query_options,
                        bool for_features);

}  // namespace crumple::cli
