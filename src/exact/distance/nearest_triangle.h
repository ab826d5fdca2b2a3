#pragma once

// Decides which of a few triangles is the closest one to a point, in exact arithmetic where float64 and double words
// are not certain. Host only.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/cancellation.h"
#include "exact/distance/triangle_features.h"

namespace crumple {

/// Returns a point and a triangle as features.
inline Features vertex_and_face(const Vec3d& p, const TrianglePoints& triangle) {
    return {FeatureKinds::vertex_face, {p, triangle[0], triangle[1], triangle[2]}};
}

/// Triangle that may be the closest one to a point.
struct NearTriangle {
    std::int32_t triangle;
    TrianglePoints points;
};

/// Distance of a point from the closest of several triangles.
struct NearestTriangle {
    std::int32_t triangle;  ///< the closest one; of equally close ones the lowest
    double distance;        ///< rounded to the nearest float64, ties to even; +inf beyond the largest
    Vec3d point;            ///< closest point of the triangle, each coordinate rounded likewise; +0 for zero
};

/// Returns the closest of the triangles, or nothing if the point lies on one of them. `near`: at least one, sorted by
/// number. `closest`: index of the one that seems to be the closest. `in_range`: true if all coordinates are in the
/// range of double-double arithmetic (search/containment/placed_surface.h); all finite coordinates are valid if it is
/// false. Increments `rational` if rational arithmetic was needed. Cost: about half a microsecond, or some microseconds
/// for each triangle in rational arithmetic.
std::optional<NearestTriangle> decide_nearest(const Vec3d& p, std::span<const NearTriangle> near, std::size_t closest,
                                              bool in_range, Cancellation& cancellation, std::int64_t& rational);

}  // namespace crumple
