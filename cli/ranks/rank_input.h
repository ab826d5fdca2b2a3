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
    io::TriangleMesh mesh;                 ///< corners count in its vertices
    std::optional<io::TriangleMesh> end;   ///< of a step: the same vertices at its end
    std::vector<std::int64_t> vertex_ids;  ///< over all ranks, ascending
    bool has_copies = false;               ///< a rank has vertices of another one's block
    io::Blocks triangles;                  ///< of all ranks
    bool weld = false;                     ///< vertices at equal positions are to be one

    MeshShare share() const;
};

/// Collective. Reads a mesh, or for two files one mesh at the start and at the end of a step. Each rank reads its rows
/// where the files are binary PLY of triangles or binary STL; any other, and standard input, rank 0 reads and hands
/// out. So it does, too, `for_features`, where vertices become one as they are read: their numbers are in the result.
/// Throws the same Error on all ranks, also for lines and points.
RankInput read_on_ranks(RankLink& link, const std::vector<std::string>& files, const QueryOptions& query_options,
                        bool for_features);

}  // namespace crumple::cli
