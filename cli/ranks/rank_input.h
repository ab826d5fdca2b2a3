#pragma once

// Local mesh of each rank: a block of the file's triangles, with the vertices that they name.

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
    io::TriangleMesh mesh;                 ///< corners are indices of its vertices
    std::optional<io::TriangleMesh> end;   ///< for a step: the same vertices at its end
    std::vector<std::int64_t> vertex_ids;  ///< over all ranks, ascending
    bool has_copies = false;               ///< true if any rank has vertices of another one's block
    io::Blocks triangles;                  ///< blocks of all ranks
    bool weld = false;                     ///< vertices at equal positions must be welded

    MeshShare share() const;
};

/// Collective. Reads a mesh, or for two files one mesh at the start and at the end of a step. Each rank reads its rows
/// of files that are binary PLY of triangles or binary STL; rank 0 reads and distributes other files and standard
/// input. If `for_features`, it also does so for files whose vertices are welded on reading, since results contain the
/// numbers of welded vertices. Throws the same Error on all ranks, also for lines and points.
RankInput read_on_ranks(RankLink& link, const std::vector<std::string>& files, const QueryOptions& query_options,
                        bool for_features);

}  // namespace crumple::cli
