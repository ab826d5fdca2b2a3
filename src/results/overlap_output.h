#pragma once

// Assembles results of overlap queries.

#include <array>
#include <vector>

#include "crumple/overlaps.h"
#include "exact/overlap/overlap_totals.h"

namespace crumple {

struct VertexVector {
    std::int32_t vertex;
    Vec3d value;
};
struct VertexWinding {
    std::int32_t vertex, winding;
};

/// A curve in which the surfaces cross.
struct OverlapCurve {
    bool closed = false;
    Vec3d area_vector, torque;    ///< about the row's torque point; NaN if it is open
    std::vector<Vec3d> points;    ///< one more than segments
    std::vector<Pair> triangles;  ///< by segment
};

/// Result for one pair of bodies.
struct OverlapRow {
    bool exists = false;  ///< the surfaces meet, or one has a component inside the other
    OverlapRelation relation = OverlapRelation::overlapping;
    OverlapNumbers numbers;
    // As far as requested, of the first and the second body, in the order of vertices:
    std::array<std::vector<VertexVector>, 2> gradient;
    std::array<std::vector<VertexWinding>, 2> windings;
    std::vector<OverlapCurve> curves;
    double body_volume = 0;  ///< of a body with itself: its own volume
};

/// Memory of a row's lists.
std::size_t bytes_of(const OverlapRow& row);

/// Turns bodies inside out whose orientation is −1.
void orient(int first, int second, OverlapRow& row);

/// Empty, with arrays that are all counted by `meter`.
Overlaps metered_overlaps(MemoryMeter* meter);
/// Gives `theirs` the result, and keeps the storage of `theirs`, emptied.
void hand_over(Overlaps& mine, Overlaps& theirs);
/// Forgets all.
void clear(Overlaps& result);

/// Begins a result without rows. Numbers by body are those of bodies whose surfaces are not closed.
void begin(const OverlapQuery& query, std::int32_t worlds, std::int32_t bodies, Overlaps& result);
/// Adds what the row of a body with itself says of that body.
void add_body(std::int32_t body, const OverlapRow& row, Overlaps& result);

/// The numbers of surfaces that are not closed: NaN, but for the torque point.
OverlapNumbers undefined_numbers(const Vec3d& point);
/// True if a query wants the row.
bool is_listed(const OverlapQuery& query, const OverlapRow& row);

/// Tells which bodies have been left out, named any number of times.
void add_skipped(std::vector<std::int32_t> bodies, Overlaps& result);

/// Adds a row, as far as the query's output has it. `world`: that of the row, or −1.
void add_row(const OverlapQuery& query, const BodyPair& bodies, std::int32_t world, const OverlapRow& row,
             Overlaps& result);

}  // namespace crumple
