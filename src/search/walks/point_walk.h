#pragma once

// Finds the triangles of a surface that may be the closest ones to a point: walks the tree of the posed surface, and
// prunes boxes and triangles that are certainly farther away than the closest triangle so far.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "crumple/array.h"
#include "exact/distance/nearest_triangle.h"
#include "exact/proximity/closest_guess.h"
#include "scene/shape_tree.h"
#include "search/containment/placed_surface.h"

namespace crumple {

/// Closest point of a triangle to a point p, as float64 guesses it, and an upper bound on the distance.
struct GuessedPoint {
    Vec3d away;    ///< from p to the closest point; may be slightly wrong
    double upper;  ///< the distance is certainly at most this; not finite if a coordinate exceeds 2^230
    detail::Differences differences;

    GuessedPoint(const Vec3d& p, const TrianglePoints& triangle);
};

/// Tree of a surface under its pose. Coordinates that are not all in the range of double-double arithmetic are
/// multiplied by scale(), a power of two that makes the largest one about 1. That is exact but for underflow, which the
/// bounds of PointWalk cover.
class SurfaceTree {
   public:
    /// `surface`: not owned; at least one triangle. Cost: O(m log m) for m triangles, about 25 ms for 100,000.
    SurfaceTree(const PlacedSurface& surface, MemoryMeter* meter);
    SurfaceTree(const SurfaceTree&) = delete;
    SurfaceTree& operator=(const SurfaceTree&) = delete;

    const PlacedSurface& surface() const { return surface_; }
    /// Returns the surface with scaled coordinates.
    const PlacedSurface& scaled() const { return scaled_; }
    double scale() const { return scale_; }
    const ShapeTree& tree() const { return tree_; }

    /// Triangles of a group, in float32, in the frame of the tree's boxes.
    struct SmallTriangles {
        using Lanes = float[ShapeTree::most_elements];
        alignas(64) Lanes corner[3][3]{};  ///< by corner and axis

        /// Returns the vector from (x, y, z) to a corner of triangle k.
        Vec3f vector(std::size_t c, std::size_t k, float x, float y, float z) const {
            return {corner[c][0][k] - x, corner[c][1][k] - y, corner[c][2][k] - z};
        }
    };
    const SmallTriangles& small(std::int32_t group) const { return small_[group]; }

    /// Returns the winding number of the scaled surface, shifted forward, at p. Cost: some microseconds.
    std::int32_t winding_at(const Vec3d& p) const;

   private:
    SmallTriangles small_triangles(const ShapeTree::Group& group) const;

    PlacedSurface surface_, scaled_;
    Array<Vec3d> scaled_points_;  ///< empty if the scale is 1
    double scale_ = 1;
    ShapeTree tree_;
    Array<SmallTriangles> small_;  ///< by group
};

/// Runs one walk after another and reuses its memory. Used by one thread at a time.
class PointWalk {
   public:
    explicit PointWalk(const SurfaceTree& surface) : surface_(surface), tree_(surface.tree()) {}

    /// Finds all triangles that may be the closest ones to p, which is in scaled coordinates. `start`: a triangle that
    /// is probably close, or -1. Cost: about two microseconds for a good start and 100,000 triangles.
    void find(const Vec3d& p, std::int32_t start);

    /// Returns the triangles that the last walk has found, at least one, sorted, with scaled coordinates.
    std::span<const NearTriangle> near() const { return near_; }
    /// Returns the index of the one that seems to be the closest.
    std::size_t closest() const { return closest_; }
    /// Return bounds on the distance, in scaled units. Cost of lower(): some nanoseconds for each triangle.
    /// @{
    double upper() const { return upper_; }
    double lower() const;
    /// @}

   private:
    struct Found {
        std::int32_t triangle;
        GuessedPoint guess;
        TrianglePoints points;
    };

    float squared_gap(std::int32_t node) const;
    void walk(std::int32_t node);
    void visit(std::int32_t group);
    void test(const ShapeTree::Group& group, std::size_t k);
    void set_upper(double upper);

    const SurfaceTree& surface_;
    const ShapeTree& tree_;

    // State of the current walk:
    Vec3d p_;
    float in_frame_[3]{};  ///< p in the frame of the tree's boxes
    double frame_error_ = 0;
    double upper_ = 0;  ///< lowest upper bound on the distance so far
    float limit_ = 0;   ///< largest squared distance in the frame that is not pruned
    std::vector<Found> found_;
    std::vector<NearTriangle> near_;
    std::size_t closest_ = 0;
};

}  // namespace crumple
