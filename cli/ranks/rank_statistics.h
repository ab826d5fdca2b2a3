#pragma once

// Statistics of all ranks together.

#include <cstdint>
#include <string>

#include "cli/ranks/rank_link.h"
#include "crumple/distributed.h"

namespace crumple::cli {

/// Collective. Returns sums over all ranks of counts and stage times, and maxima of wall-clock times and peak memory.
/// `mine.search.threads`: number of threads of this rank; `mine.search.triangles` and `mine.search.pairs`: numbers over
/// all ranks, which stay as they are.
DistributedStatistics total(RankLink& link, DistributedStatistics mine);

/// Prints the table of --stats to standard error, with `remark` beside the number of pairs. Only rank 0 prints.
void print_statistics(const RankLink& link, const DistributedStatistics& totals, const std::string& remark);

}  // namespace crumple::cli
