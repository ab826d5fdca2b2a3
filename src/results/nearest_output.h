#pragma once

// The answer about nearest bodies, as it is put together.

#include <optional>

#include "crumple/distances.h"
#include "exact/distance/rational_nearest.h"

namespace crumple {

/// What is told of one pair of bodies.
struct NearestRow {
    double squared = 0;
    bool touching = false;
    Pair triangles{};
    Witnesses points;
};

/// Empty, with arrays that are all counted by `meter`.
Distances metered_nearest(MemoryMeter* meter);
/// Gives `theirs` the answer, and keeps the storage of `theirs`, emptied.
void hand_over(Distances& mine, Distances& theirs);
void clear(Distances& answer);

/// Makes place for rows of these bodies, as many as `answer.bodies` has.
void make_rows(Distances& answer);
void put_row(Distances& answer, std::size_t i, const NearestRow& row);
/// Drops the rows that `kept` has 0 for; the order stays.
void keep_rows(Distances& answer, const Array<std::uint8_t>& kept);

}  // namespace crumple
