#pragma once

// Distances from points to a set of triangles, in float64.

#include <cstdint>
#include <vector>

#include "scene/shape_tree.h"
#include "search/walks/point_walk.h"

namespace crumple::checks {

class TriangleSet {
   public:
    /// Closest triangle to a point, by its index; the distance has a relative error below 2^-40.
    struct Nearest {
        double distance;
        std::int32_t triangle;
    };

    /// `triangles`: at least one. O(n log n).
    explicit TriangleSet(std::vector<TrianglePoints> triangles);

    /// Returns the closest triangle. `start`: one that is probably close, or -1. O(log n) as a rule.
    Nearest nearest(const Vec3d& p, std::int32_t start) const;
    double distance(const Vec3d& p, std::int32_t triangle) const {
        return GuessedPoint(p, triangles_[static_cast<std::size_t>(triangle)]).upper;
    }
    const TrianglePoints& operator[](std::int32_t triangle) const {
        return triangles_[static_cast<std::size_t>(triangle)];
    }

    /// Calls visit(triangle) for the triangles of the groups whose boxes overlap `box`: all that overlap it, and
    /// others.
    template <class Visit>
    void for_each_near(const Bounds& box, Visit visit) const {
        for_each_overlap(tree_, Placement(), box, [&](std::int32_t g) {
            const ShapeTree::Group& group = tree_.group(g);
            for (std::int32_t k = 0; k < group.count; ++k) visit(group.element[static_cast<std::size_t>(k)]);
        });
    }

   private:
    void visit(std::int32_t node, const Vec3d& p, Nearest& best) const;

    std::vector<TrianglePoints> triangles_;
    ShapeTree tree_{nullptr};
};

}  // namespace crumple::checks
