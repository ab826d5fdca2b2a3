#pragma once

// Pairs of triangles: the rows of all ranks together.

#include <cstdint>

#include "cli/ranks/rank_link.h"
#include "cli/ranks/rank_output.h"
#include "crumple/distributed.h"
#include "io/bytes/slice.h"

namespace crumple::cli {

/// Collective. How many triangles of all ranks are in some pair. `triangles`: whose rows are whose.
std::int64_t count_hits(RankLink& link, const DistributedIntersections& found, io::Blocks triangles);

/// The rows of this rank as .txt or .csv; rank 0 begins with what stands before all rows. `found`: kept by reference.
RankText text_of(const RankLink& link, const DistributedIntersections& found, bool contacts, io::PairFormat format);

/// Collective. On rank 0 the answer as one process has it, but for its statistics; on the others nothing.
Intersections collect(RankLink& link, const DistributedIntersections& found, io::Blocks triangles);

}  // namespace crumple::cli
