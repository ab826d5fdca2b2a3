#pragma once

// Crossings of faces of one surface (sheets), decided without a shift. Host only.

#include <algorithm>
#include <array>

#include "exact/integer.h"
#include "geometry/predicates.h"
#include "results/joined_curves.h"

namespace crumple {

/// Returns the sign of the volume that a face spans with a point. `in_range`: true if expansions can represent it.
inline int side_of_face(const FaceCorners& face, const Vec3d& p, bool in_range) {
    if (in_range) return orient3d(face[0], face[1], face[2], p);
    const std::array<Vec3d, 4> points{face[0], face[1], face[2], p};
    const auto q = in_units(points, common_exponent(points));
    return dot(cross(q[1] - q[0], q[2] - q[0]), q[3] - q[0]).sign();
}

/// Sides of the corners of one face relative to the plane of another face of the same surface; 0 for common vertices.
struct CornerSides {
    std::array<int, 3> side{};
    std::array<bool, 3> common{};

    CornerSides(const FaceOfSurface& of, const FaceOfSurface& face, bool in_range) {
        const FilteredPlane plane(face.corner);
        for (std::size_t k = 0; k < 3; ++k) {
            common[k] = std::count(face.vertex.begin(), face.vertex.end(), of.vertex[k]) != 0;
            if (common[k]) continue;
            side[k] = in_range ? plane.side(of.corner[k]) : undecided;
            if (side[k] == undecided) side[k] = side_of_face(face.corner, of.corner[k], in_range);
        }
    }
    /// True if all corners are on one side, so that the faces have no common point.
    bool apart() const { return side[0] != 0 && side[0] == side[1] && side[1] == side[2]; }
};

/// True if an edge of one face passes through another face of the same surface, or may do so once the faces are in
/// general position: edges at common vertices do not.
inline bool edges_pierce(const FaceOfSurface& edges, const CornerSides& sides, const FaceOfSurface& face,
                         bool in_range) {
    const auto& [side, common] = sides;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = next_corner(k);
        if (common[k] || common[next] || side[k] * side[next] > 0 || (side[k] == 0 && side[next] == 0)) continue;
        bool left = false, right = false;
        for (std::size_t i = 0; i < 3; ++i) {
            const FaceCorners wing{edges.corner[k], edges.corner[next], face.corner[i]};
            const int turn = side_of_face(wing, face.corner[next_corner(i)], in_range);
            left |= turn > 0, right |= turn < 0;
        }
        if (!(left && right)) return true;
    }
    return false;
}

/// True if two faces of one surface without a common edge cross, or may do so.
inline bool sheets_may_cross(const FaceOfSurface& one, const FaceOfSurface& other, bool in_range) {
    const CornerSides of_one(one, other, in_range);
    if (of_one.apart()) return false;
    const CornerSides of_other(other, one, in_range);
    return !of_other.apart() &&
           (edges_pierce(one, of_one, other, in_range) || edges_pierce(other, of_other, one, in_range));
}

}  // namespace crumple
