#pragma once

// Places where surfaces meet: connected groups of pairs of triangles that intersect.

#include <cstdint>
#include <span>
#include <vector>

#include "checks/body_report.h"
#include "crumple/intersections.h"

namespace crumple::checks {

/// Two pairs (a, b) and (c, d) of triangles of the same two shells are connected if a and c are equal or have a vertex
/// in common, and b and d, too; within one shell also if this holds after exchanging the triangles of a pair. So the
/// segments of a curve in which two surfaces cross are one place, and two curves through one large triangle are two.
struct CrossingPlace {
    BodyPair shells{0, 0};
    std::vector<std::int32_t> rows;  ///< its pairs, by index in the list of intersections; ascending
    std::int64_t triangles = 0;      ///< number of different triangles in these pairs
    BoundingBox box{};               ///< box of the points in which the triangles meet
    Point centre{};                  ///< middle of the box
};

/// Returns the union of places of the same two shells. `found`: as for find_places().
CrossingPlace joined(std::span<const CrossingPlace* const> places, const Intersections& found);

/// Returns the places in the order of the shells, and for equal shells by their first pairs. `found`: intersections
/// with contacts of a world whose bodies are the shells. O(n log n) for n pairs.
std::vector<CrossingPlace> find_places(const Intersections& found, std::span<const io::TriangleMesh* const> shells);

}  // namespace crumple::checks
