#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "crumple/array.h"
#include "crumple/intersections.h"
#include "crumple/world.h"

namespace crumple {

struct Distances;

/// Query for the distance of each pair of bodies of a world (docs/nearest.md). A value: it owns its data.
struct DistanceQuery {
    using Result = Distances;

    /// `pairs`: a row for each pair of bodies. `nearest`: a row for each world, with its nearest pair of bodies; costs
    /// less, since a pair of bodies is dropped as soon as it is certainly not the nearest. Pairs among bodies that are
    /// in all worlds belong to no world, so `nearest` has no row for them.
    Output output = Output::pairs;
    /// Reports only pairs of bodies whose distance is at most this: Euclidean, 0 or more, or infinite; in the units of
    /// the world. Not rounded.
    double radius = std::numeric_limits<double>::infinity();
    /// Pairs of triangles that count. Pairs within a body never count, so `bodies` must not be `within`.
    PairFilter filter = {};
};

/// Result of a DistanceQuery: one row for each pair of bodies that has a pair of triangles selected by the filter, at
/// most `radius` apart. First body < second body; sorted by first body, then by second body, so worlds follow each
/// other, and pairs among bodies that are in all worlds come last; `nearest` keeps one row of each world. Results are
/// the same bytes from every backend, thread count and instruction set. A plain value: copy it to keep it beyond the
/// detector's next call.
struct Distances {
    bool any = false;        ///< true if there is a row
    std::int64_t count = 0;  ///< number of rows

    Array<BodyPair> bodies;
    /// Squared distance of the bodies' triangles as closed sets of points: 0 if some intersect. Exact, then rounded to
    /// the nearest number; infinite if it overflows.
    Array<double> squared_distance;
    Array<std::uint8_t> touching;  ///< 1: the distance is 0 exactly; a squared distance may also be rounded to 0
    Array<Pair> triangles;         ///< the first pair of triangles at that distance, indices within their bodies
    /// Closest points of these triangles: one of the first body and one of the second, exact, then rounded to the
    /// nearest numbers. If the triangles intersect: the lexicographically smallest point of the intersection, twice. If
    /// several pairs of points are equally close: those of the first pair of features, in the order of docs/nearest.md.
    Array<std::array<std::array<double, 3>, 2>> points;

    /// For `nearest`, per world: its row, or -1 if no pair of its bodies is within the radius. The nearest pair is the
    /// one of least squared distance, the first of several.
    Array<std::int64_t> world_rows;

    Statistics statistics;
};

}  // namespace crumple
