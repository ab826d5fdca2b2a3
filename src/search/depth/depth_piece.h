#pragma once

// Pieces of faces of one surface, and upper bounds on the depths of their points in another surface, B.
//
// The depth of a point is its distance to B, or 0 if the winding number of B is 0 there. Its signed depth D is negative
// instead: minus the distance. A segment from an inner to an outer point meets B, so D is 1-Lipschitz: |D(x) - D(y)| <=
// |x - y|. On a piece of a face with corners c_k, D is at most min_k (D(c_k) + max_j |c_j - c_k|). It is also at most
// the distance to any triangle of B, which is a convex function, so it is at most max_k of the distances of the corners
// to that triangle. The second bound is exact if one triangle is the closest one to all corners.

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "search/walks/point_walk.h"

namespace crumple {

/// Factors that cover the rounding errors of a few operations.
inline constexpr double wider = 1 + 0x1p-44, narrower = 1 - 0x1p-44;

/// Point of a face.
struct FacePoint {
    Vec3d at;
    bool is_inside = false;     ///< true if the winding number of B is not 0, and the point is not on B
    double radius = 0;          ///< lower bound on the distance to B
    double upper = 0;           ///< upper bound on the signed depth
    std::int32_t nearest = -1;  ///< triangle of B that seems to be the closest one, or -1

    double least_depth() const { return is_inside ? radius : 0; }
};

/// Triangle that is part of a face.
struct Piece {
    std::array<FacePoint, 3> corner;
    double bound = std::numeric_limits<double>::infinity();  ///< upper bound on the depth in the piece
    int level = 0;                                           ///< number of times that the face was halved
};

/// Returns the distance of two points, with a relative error below 2^-50.
inline double distance_between(const Vec3d& p, const Vec3d& q) {
    const Vec3d d = p - q;
    return std::hypot(d.x, d.y, d.z);
}

inline bool is_in(const Vec3d& p, const Bounds& box) { return overlap(Bounds{p, p}, box); }

/// Returns the upper bound on the depth that follows from its Lipschitz constant.
inline double lipschitz_bound(const Piece& piece) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const FacePoint& from = piece.corner[k];
        const double reach = max(distance_between(from.at, piece.corner[(k + 1) % 3].at),
                                 distance_between(from.at, piece.corner[(k + 2) % 3].at));
        least = min(least, from.upper + wider * reach);
    }
    const double error =
        (wider - 1) * max(0.0, -min(piece.corner[0].upper, min(piece.corner[1].upper, piece.corner[2].upper)));
    return wider * max(0.0, least + error) + 0x1p-1000;
}

/// Returns the bound from the convex distances to the corners' closest triangles, or `most` if none is lower.
inline double convex_bound(const Piece& piece, const PlacedSurface& other, double most) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t nearest = piece.corner[k].nearest;
        const bool is_repeated =
            (k > 0 && nearest == piece.corner[0].nearest) || (k > 1 && nearest == piece.corner[1].nearest);
        if (nearest < 0 || is_repeated) continue;
        double greatest = 0;
        for (std::size_t j = 0; j < 3 && greatest < most; ++j)
            greatest = max(greatest, GuessedPoint(piece.corner[j].at, other.corners(nearest)).upper);
        most = min(most, greatest);
    }
    return most;
}

/// Returns the longest edge of a piece, as its start, or nothing if it is too short or too long to be halved.
inline std::optional<std::size_t> longest_edge(const Piece& piece) {
    std::size_t longest = 0;
    double most = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = distance_between(piece.corner[k].at, piece.corner[(k + 1) % 3].at);
        if (length > most) longest = k, most = length;
    }
    const Vec3d &p = piece.corner[longest].at, &q = piece.corner[(longest + 1) % 3].at, m = 0.5 * p + 0.5 * q;
    if (!(most < std::numeric_limits<double>::infinity()) || m == p || m == q) return std::nullopt;
    return longest;
}

}  // namespace crumple
