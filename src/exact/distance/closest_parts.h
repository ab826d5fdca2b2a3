#pragma once

// Closest parts (vertices, edges, faces) of two triangles, identified by their points, so that equal parts of different
// triangles are recognised without arithmetic: the six or more triangles at a mesh vertex are often equally close to
// another triangle. Host only.

#include <algorithm>
#include <span>

#include "exact/distance/filtered_nearest.h"
#include "exact/proximity/decide_distance.h"

namespace crumple {

/// Part of a triangle: one to three of its corners.
struct TrianglePart {
    std::array<Vec3d, 3> point;
    std::size_t count = 0;

    std::span<const Vec3d> points() const { return {point.data(), count}; }
    bool has(const Vec3d& p) const { return std::find(points().begin(), points().end(), p) != points().end(); }
    bool is_part_of(const TrianglePoints& triangle) const {
        return std::all_of(points().begin(), points().end(), [&](const Vec3d& p) {
            return std::find(triangle.begin(), triangle.end(), p) != triangle.end();
        });
    }
};

/// Closest parts of two triangles. The parts have exactly one pair of closest points: they are never two nearly
/// parallel edges, because for such edges the guess is always a vertex on at least one side.
class ClosestParts {
   public:
    /// Constructs the parts that `quick` has found for the triangles a and b.
    ClosestParts(const TrianglePoints& a, const TrianglePoints& b, const FilteredNearest& quick)
        : direction_(quick.direction()), error_(quick.error()) {
        const std::size_t k = quick.feature();
        if (k < 3) {
            first_ = {{a[k]}, 1}, second_ = part_of_face(b, quick.type());
        } else if (k < 6) {
            second_ = {{b[k - 3]}, 1}, first_ = part_of_face(a, quick.type());
        } else {
            const auto type = static_cast<EdgeEdgeType>(quick.type());
            using enum EdgeEdgeType;
            first_ = part_of_edge(a, (k - 6) / 3, type == EA0_EB0 || type == EA0_EB1 || type == EA0_EB,
                                  type == EA1_EB0 || type == EA1_EB1 || type == EA1_EB);
            second_ = part_of_edge(b, (k - 6) % 3, type == EA0_EB0 || type == EA1_EB0 || type == EA_EB0,
                                   type == EA0_EB1 || type == EA1_EB1 || type == EA_EB1);
        }
    }

    /// Returns the parts as features; that of the second triangle comes first if second_comes_first().
    Features features() const {
        const auto& [p, q] =
            std::array{second_comes_first() ? second_ : first_, second_comes_first() ? first_ : second_};
        if (p.count == 2) return {FeatureKinds::edge_edge, {p.point[0], p.point[1], q.point[0], q.point[1]}};
        const FeatureKinds kinds = q.count == 3   ? FeatureKinds::vertex_face
                                   : q.count == 2 ? FeatureKinds::vertex_edge
                                                  : FeatureKinds::vertex_vertex;
        return {kinds, {p.point[0], q.point[0], q.point[1], q.point[2]}};
    }
    bool second_comes_first() const { return first_.count > second_.count; }

    /// True if both triangles have these parts and their distance is certainly that of the parts: along the direction
    /// between the parts' closest points, all other corners are certainly farther from the other triangle.
    bool are_closest_of(const TrianglePoints& a, const TrianglePoints& b) const {
        if (!(error_ < std::numeric_limits<double>::infinity())) return false;
        if (!first_.is_part_of(a) || !second_.is_part_of(b)) return false;
        return beyond(a, first_, direction_) && beyond(b, second_, -1.0 * direction_);
    }

   private:
    static TrianglePart part_of_face(const TrianglePoints& face, std::uint8_t type) {
        const auto side = static_cast<std::size_t>(type) % 3;
        if (type < 3) return {{face[side]}, 1};
        if (type < 6) return {{face[side], face[(side + 1) % 3]}, 2};
        return {face, 3};
    }
    static TrianglePart part_of_edge(const TrianglePoints& triangle, std::size_t i, bool begin, bool end) {
        const Vec3d &p = triangle[i], &q = triangle[(i + 1) % 3];
        if (begin || end) return {{begin ? p : q}, 1};
        return {{p, q}, 2};
    }

    bool beyond(const TrianglePoints& triangle, const TrianglePart& part, const Vec3d& along) const {
        return std::all_of(triangle.begin(), triangle.end(), [&](const Vec3d& p) {
            if (part.has(p)) return true;
            const Vec3d away = p - part.point[0];
            const double length = detail::length_1(away);
            const double error = (8 * detail::near_epsilon * largest(abs(along)) + 1.1 * error_) * length;
            return dot(along, away) > error + detail::near_slack;
        });
    }

    TrianglePart first_, second_;
    Vec3d direction_;
    double error_;
};

}  // namespace crumple
