#pragma once

// Assembles results of overlap queries.

#include <array>
#include <limits>
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

/// Vertex of a surface at which the winding number of another one is not 0, and its depth in it.
struct VertexDepth {
    std::int32_t vertex;
    double depth;           ///< distance to the other surface, rounded to the nearest float64; +inf beyond the largest
    Vec3d nearest;          ///< closest point of the other surface, each coordinate rounded to the nearest float64
    std::int32_t triangle;  ///< triangle of the other surface that has this point: the lowest of the closest ones

    friend bool operator==(const VertexDepth&, const VertexDepth&) = default;
};

/// Bounds on the greatest depth of two bodies in each other, in units of length.
struct DepthBounds {
    double lower = 0;  ///< depth of some point, rounded down
    double upper = 0;  ///< no point is deeper; rounded up
};

/// Curve in which the surfaces cross.
struct OverlapCurve {
    bool closed = false;
    std::int32_t region = -1;     ///< index in OverlapRow::regions, if those are requested
    Vec3d area_vector, torque;    ///< both NaN if the curve is open; the torque is about the row's torque point
    std::vector<Vec3d> points;    ///< ends of successive segments: one more than segments, also in a closed curve
    std::vector<Pair> triangles;  ///< per segment, the two triangles that cross in it
};

/// Box and thickness of an overlap or of a region.
struct OverlapExtent {
    Vec3d low, high;  ///< rounded outwards
    double thickness = 0;
};
inline constexpr OverlapExtent no_extent = [] {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return OverlapExtent{{nan, nan, nan}, {nan, nan, nan}, nan};
}();

/// Connected piece of the boundary of an overlap.
struct OverlapRegion {
    OverlapNumbers numbers;
    OverlapExtent extent;
    bool merged = false;
    std::array<std::int32_t, 2> pieces{};  ///< by surface: number of its connected pieces
};

/// Bounds on the least translation that separates two bodies.
struct TranslationBounds {
    double low = std::numeric_limits<double>::quiet_NaN(), high = low;
    Vec3d translation{low, low, low};  ///< a translation of the second body that separates them, of length `high`
};

/// Volumes of the union of two bodies, and of each body without the other.
struct UnionVolumes {
    static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    double volume = nan, share = nan;  ///< `share`: volume of the overlap divided by that of the union
    std::array<double, 2> difference{nan, nan};
};

/// Result for one pair of bodies.
struct OverlapRow {
    bool exists = false;  ///< true if the surfaces meet, or one has a connected component inside the other
    OverlapRelation relation = OverlapRelation::overlapping;
    OverlapNumbers numbers;
    // If requested, for the first and the second body; in the order of vertices:
    std::array<std::vector<VertexVector>, 2> gradient;
    std::array<std::vector<VertexWinding>, 2> windings;
    std::array<std::vector<VertexDepth>, 2> depths;
    std::vector<OverlapCurve> curves;
    OverlapExtent extent = no_extent;
    std::vector<OverlapRegion> regions;
    UnionVolumes unions;
    DepthBounds depth_bounds{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    std::vector<double> withdrawals, first_free;  ///< by direction of the query; empty if they are undefined
    TranslationBounds translation;                ///< the lower bound holds for solids
    double body_volume = 0;  ///< set for the overlap of a body with itself: the volume of that body
};

/// Returns the bytes of a row's lists.
std::size_t bytes_of(const OverlapRow& row);

/// Converts a row to that of the same bodies with some of them turned inside out: the first body if `first` is −1 (else
/// 1), the second if `second` is −1 (else 1).
void orient(int first, int second, OverlapRow& row);

/// Returns an empty result whose arrays are counted by the meter.
Overlaps metered_overlaps(MemoryMeter* meter);
/// Moves the result `mine` to `theirs`. `mine` keeps the memory of `theirs`, emptied.
void swap_out(Overlaps& mine, Overlaps& theirs);
/// Empties a result, but keeps its memory.
void clear(Overlaps& result);

/// Begins a result without rows. If the query requests all pairs and self_overlaps, sets body_volume to NaN and
/// is_solid to 0 for all bodies, as for bodies whose surfaces are not closed.
void begin(const OverlapQuery& query, std::int32_t worlds, std::int32_t bodies, Overlaps& result);
/// Begins the offsets of lists that belong to rows, of a result without rows.
void begin_rows(const OverlapQuery& query, Overlaps& result);
/// True if the overlap of a body with itself proves that the body is a solid.
inline bool is_solid(const OverlapRow& row) { return row.numbers.volume.scaled.mantissa == 0; }
/// Sets body_volume and is_solid of a body from the row of its overlap with itself, if begin() made these arrays.
void add_body(std::int32_t body, const OverlapRow& row, Overlaps& result);

/// Returns the numbers for surfaces that are not closed: NaN, except for the torque point.
OverlapNumbers undefined_numbers(const Vec3d& point);
/// True if the row belongs to the result: its bodies overlap or touch, and its volume is not below min_volume.
bool is_in_result(const OverlapQuery& query, const OverlapRow& row);

/// Lists the bodies that were skipped. `bodies` may contain duplicates.
void add_skipped(std::vector<std::int32_t> bodies, Overlaps& result);

/// Adds a row to the arrays that the query's output includes. `world`: world index of the row, or −1 for two bodies
/// that are in all worlds. `solids`: true if both bodies are known to be solids.
void add_row(const OverlapQuery& query, const BodyPair& bodies, std::int32_t world, const OverlapRow& row, bool solids,
             Overlaps& result);

}  // namespace crumple
