#pragma once

// Lists of results of all ranks together.

#include <cstdint>
#include <functional>

#include "cli/ranks/rank_input.h"
#include "cli/ranks/rank_link.h"
#include "cli/ranks/rank_texts.h"
#include "crumple/distributed.h"

namespace crumple::cli {

/// Rows of a result that this rank writes, in the order of the whole list. Refers to the input and the result, which
/// must outlive it.
template <class Result>
struct RankList {
    io::RowTable table;
    RankSections sections;
    /// Collective. Returns the whole list on rank 0, and an empty one on the other ranks.
    std::function<Result()> collect;
};

// Collective. Return the rows of a result that this rank writes.
RankList<Intersections> rank_list_of(RankLink& link, const RankInput& input, const IntersectionQuery& query,
                                     const DistributedIntersections& found);
RankList<Impacts> rank_list_of(RankLink& link, const RankInput& input, const ImpactQuery& query,
                               const DistributedImpacts& found);
RankList<Proximities> rank_list_of(RankLink& link, const RankInput& input, const ProximityQuery& query,
                                   const DistributedProximities& found);

/// Collective. Returns the number of triangles, over all ranks, that are part of some pair.
std::int64_t count_hits(RankLink& link, const DistributedIntersections& found, io::Blocks triangles);

}  // namespace crumple::cli
