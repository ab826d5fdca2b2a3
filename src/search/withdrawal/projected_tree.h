#pragma once

// Boxes of a surface's triangles, projected along a direction, and a tree over them that is built while it is searched.
//
// The direction's largest component is along the *axis*. A projected point has three coordinates: two on the plane
// through the origin perpendicular to the axis, to which points move along the direction, and its *height*, the
// coordinate along the axis (with the direction's sign). Heights are exact, and if points x and y project to one place,
// x − y is (height of x − height of y) / |component along the axis| times the direction.

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "search/containment/placed_surface.h"

namespace crumple {

/// Projected point, without its height.
struct Place {
    double u, v;

    friend Place operator-(const Place& p, const Place& q) { return {p.u - q.u, p.v - q.v}; }
    friend double dot(const Place& p, const Place& q) { return p.u * q.u + p.v * q.v; }
};

/// Rectangle, in any orientation, that contains the places of some triangles. Walls that are parallel to the direction
/// have thin rectangles, which separate walls with little clearance.
struct PlaceRectangle {
    Place middle{0, 0};
    Place along{0, 0};  ///< direction of the long side, of length 1
    double half_length = 0, half_width = 0;

    Place across() const { return {-along.v, along.u}; }
};

/// True if two rectangles are farther apart than the margin, along a side of either one. `margin`:
/// ProjectionAlong::margin().
bool are_apart(const PlaceRectangle& a, const PlaceRectangle& b, double margin);

/// Projection along a direction: to (place, place, height).
class ProjectionAlong {
   public:
    /// `direction`: finite, not 0. `largest`: at least the magnitude of all coordinates to be projected.
    ProjectionAlong(const Vec3d& direction, double largest);

    int axis() const { return axis_; }
    /// Factor of places, so that they do not overflow: place() and boxes are in units of 1 / scale().
    double scale() const { return scale_; }
    /// Returns a box that contains the projection of a triangle.
    Bounds operator()(const std::array<Vec3d, 3>& corners) const;
    /// Returns the place of a point, with an error of at most margin() / 4.
    Place place(const Vec3d& p) const;
    /// Bound on the total error of the distance of two rectangles or triangles along an axis of length 1 or less.
    double margin() const { return margin_; }

   private:
    int axis_;
    std::array<int, 2> across_;  ///< the other two axes
    double sign_;                ///< sign of the direction's component along the axis
    double scale_;               ///< factor of places: a power of two, so that they do not overflow
    std::array<double, 2> slope_, error_;
    double margin_;
};

/// Places of the corners of a triangle.
using PlaceTriangle = std::array<Place, 3>;

/// True if two triangles are farther apart than the margin, along the normal of an edge. `margin`:
/// ProjectionAlong::margin().
bool are_apart(const PlaceTriangle& a, const PlaceTriangle& b, double margin);

struct ProjectedTriangle {
    Bounds box;
    std::int32_t face;
};

/// Tree over the projected triangles of a surface. A node has children only once they are requested, so that parts of
/// the tree that no search visits are never sorted. Not thread-safe.
class ProjectedTree {
   public:
    static constexpr std::int32_t leaf_size = 4;
    static constexpr std::int32_t root = 0;

    struct Node {
        Bounds box;
        std::int32_t begin, end;   ///< indices of triangles
        std::int32_t child;        ///< the first of two children, or 0 if there are none yet
        PlaceRectangle rectangle;  ///< tight only for small nodes

        std::int32_t size() const { return end - begin; }
        bool is_leaf() const { return size() <= leaf_size; }
    };

    /// Projects a surface, which has at least one face. Surface and projection must outlive the tree. Cost: O(faces),
    /// on all threads.
    ProjectedTree(const PlacedSurface& surface, const ProjectionAlong& projection, ParallelFor& workers,
                  Cancellation& cancellation);

    const Node& node(std::int32_t index) const { return nodes_[static_cast<std::size_t>(index)]; }
    /// Returns the first of the two children of a node that is not a leaf. Cost: O(triangles of the node) at the first
    /// call. Reorders the triangles of the node, and invalidates references to nodes.
    std::int32_t first_child(std::int32_t index);

    /// The triangles of a leaf stay where they are.
    const ProjectedTriangle& triangle(std::int32_t index) const { return triangles_[static_cast<std::size_t>(index)]; }

    PlaceTriangle places(const ProjectedTriangle& triangle) const;

   private:
    std::int32_t split(const Node& node);
    Node make_node(std::int32_t begin, std::int32_t end) const;
    PlaceRectangle make_rectangle(const Node& node) const;

    const PlacedSurface& surface_;
    const ProjectionAlong& projection_;
    std::vector<ProjectedTriangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace crumple
