#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "crumple/array.h"
#include "crumple/intersections.h"
#include "crumple/world.h"

namespace crumple {

struct Distances;

/// How far apart the bodies of a world are, each pair of them (docs/nearest.md). A value: it owns what it names.
struct DistanceQuery {
    using Result = Distances;

    /// Only pairs of bodies whose distance is at most this: Euclidean, 0 or more, or infinite; in the units of the
    /// world. Exact as given.
    double radius = std::numeric_limits<double>::infinity();
    /// Which pairs of triangles count. Pairs within a body never do, so `bodies` must not be `within`.
    PairFilter filter = {};
};

/// Result of a DistanceQuery: one row for each pair of bodies that has a wanted pair of triangles, at most `radius`
/// apart. First body < second body; rows in that order, so that worlds follow each other, and pairs among bodies that
/// are in all worlds are last. The same bytes from every backend, thread count and instruction set. A plain value: copy
/// it to keep it beyond the detector's next call.
struct Distances {
    bool any = false;        ///< whether there is any row
    std::int64_t count = 0;  ///< rows

    Array<BodyPair> bodies;
    /// Of the triangles as sets of points, closed: 0 where some intersect. Exact, then rounded to the nearest number;
    /// infinite beyond the largest.
    Array<double> squared_distance;
    Array<std::uint8_t> touching;  ///< 1: the distance is 0 exactly; a squared distance may also be rounded to 0
    Array<Pair> triangles;         ///< as they count within their bodies: the first of those that are at that distance
    /// Where these triangles are closest: a point of the first body's and one of the second's, exact ones rounded to
    /// the nearest numbers. Of triangles that intersect the lexicographically smallest point of the intersection,
    /// twice. Of several pairs of points those of the first features, as docs/nearest.md counts them.
    Array<std::array<std::array<double, 3>, 2>> points;

    Statistics statistics;
};

}  // namespace crumple
