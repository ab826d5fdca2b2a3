#pragma once

// Vertices that a rank's triangles name and that another rank has read.

#include <cstdint>
#include <vector>

#include "cli/ranks/rank_link.h"
#include "crumple/io.h"
#include "io/bytes/slice.h"

namespace crumple::cli {

/// Collective. The mesh has the rank's block of vertices, and corners that are numbers over all blocks. Adds those of
/// other blocks that it names, and lets corners count in the mesh. Returns the numbers of its vertices over all ranks.
/// `moved`: the same vertices elsewhere, of which it adds the same; its triangles are not looked at.
std::vector<std::int64_t> bring_named_vertices(RankLink& link, io::Blocks blocks, io::TriangleMesh& mesh,
                                               io::TriangleMesh* moved = nullptr);

}  // namespace crumple::cli
