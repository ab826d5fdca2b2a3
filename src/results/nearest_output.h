#pragma once

// Assembles results of distance queries.

#include <optional>

#include "crumple/distances.h"
#include "exact/distance/exact_nearest.h"

namespace crumple {

/// Result for one pair of bodies.
struct NearestRow {
    double squared = 0;
    bool touching = false;
    Pair triangles{};
    Witnesses points;
};

/// Returns an empty result whose arrays are counted by the meter.
Distances metered_nearest(MemoryMeter* meter);
/// Moves the result `mine` to `theirs`. `mine` keeps the memory of `theirs`, emptied.
void swap_out(Distances& mine, Distances& theirs);
void clear(Distances& answer);

/// Resizes all arrays to the number of rows of `bodies`.
void make_rows(Distances& answer);
void put_row(Distances& answer, std::size_t i, const NearestRow& row);
/// Drops the rows whose flag in `kept` is 0; the order is preserved.
void keep_rows(Distances& answer, const Array<std::uint8_t>& kept);

}  // namespace crumple
