#pragma once

// What the ranks did, all together.

#include <cstdint>
#include <string>

#include "cli/ranks/rank_link.h"
#include "crumple/distributed.h"

namespace crumple::cli {

/// Over all ranks: sums, but the largest of wall-clock times.
struct RankTotals {
    DistributedStatistics statistics;  ///< `search` as one process would tell it, where that can be said
    int threads = 1;                   ///< of all ranks
};

/// Collective.
RankTotals total(RankLink& link, const DistributedStatistics& mine, std::int64_t triangles, std::int64_t pairs,
                 int threads);

/// What --stats prints, to standard error of rank 0, with this remark on the pairs.
void print_statistics(const RankLink& link, const RankTotals& totals, const std::string& remark);

}  // namespace crumple::cli
