#pragma once

// Assembles results of overlap queries.

#include "crumple/overlaps.h"
#include "exact/overlap/overlap_totals.h"

namespace crumple {

/// Result for one pair of bodies.
struct OverlapRow {
    bool exists = false;  ///< the surfaces meet, or one has a component inside the other
    OverlapRelation relation = OverlapRelation::overlapping;
    OverlapNumbers numbers;
};

/// Empty, with arrays that are all counted by `meter`.
Overlaps metered_overlaps(MemoryMeter* meter);
/// Gives `theirs` the result, and keeps the storage of `theirs`, emptied.
void hand_over(Overlaps& mine, Overlaps& theirs);
/// Forgets all.
void clear(Overlaps& result);

/// Adds a row, as far as the query's output has it. `world`: that of the row, or −1.
void add_row(const OverlapQuery& query, const BodyPair& bodies, std::int32_t world, const OverlapRow& row,
             Overlaps& result);

}  // namespace crumple
