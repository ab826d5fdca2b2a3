#pragma once

// Triangulation of one polygon. A convex polygon becomes a fan of triangles around its first corner. A concave one is
// triangulated by ear clipping: a corner whose triangle holds no other corner is cut off, until one triangle is left.
// All tests are made on the projection of the polygon along the coordinate axis in which its Newell normal is largest,
// with exact predicates. For a plane polygon the projection does not change the result.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vec.h"
#include "io/meshes/corner_tree.h"

namespace crumple::io {

class Triangulator {
   public:
    /// Triangulates the polygon of these n corners, four or more. `ears` must be empty. Fills it with 3 (n - 2) indices
    /// of corners, or leaves it empty if the fan around the first corner is a valid triangulation, or if the polygon
    /// has no area. Returns false if the polygon crosses or overlaps itself: the caller then uses the fan. Points may
    /// repeat, for example where a slit joins a hole to the outline. Cost: usually O(n log n), at worst O(n^2).
    bool cut(std::span<const Vec3d> points, std::vector<std::int32_t>& ears);

   private:
    struct Box {
        double left, right, low, high;
        int index;
    };

    int turn(int a, int b, int c) const;
    int plane_turn(int a, int b, int c) const;
    bool before(int a, int b) const;
    bool same_place(int a, int b) const;
    bool find_plane();
    bool has_good_fan() const;
    template <class Hit>
    bool any_overlap(Hit hit);
    bool crosses_itself();
    bool turns_back(int a, int b, int c) const;
    bool overlap_themselves(std::span<const std::int32_t> triangles);
    void orient();
    bool clip_ears(std::vector<std::int32_t>& ears);
    int find_spike(int start) const;
    bool is_ear(int b) const;
    bool opens_into(int corner, int b) const;

    std::span<const Vec3d> points_;
    int count_ = 0;
    int axis_ = 2;          ///< coordinate axis of projection
    int sign_ = 1;          ///< 1 if the projected corners run counter-clockwise, else -1
    bool exact_ = true;     ///< true if all coordinates are in the range in which floating-point expansions are exact
    bool touches_ = false;  ///< true if the outline touches itself other than where successive edges join
    CornerTree not_convex_;
    std::vector<int> before_, after_;  ///< previous and next corner of each one that is not cut off
    std::vector<std::int8_t> turns_;   ///< per corner: 1 convex, 0 straight, -1 reflex; 2 once cut off
    std::vector<Box> boxes_;           ///< boxes of edges, later of triangles; sorted by left side
};

}  // namespace crumple::io
