#pragma once

// Triangles of one polygon. A convex polygon is fanned from its first corner. A concave one is cut by clipping ears: a
// corner whose triangle holds no other corner is cut off, until a triangle is left. Both see the polygon along the axis
// in which its Newell normal is largest, which for a plane polygon changes nothing, and ask exact predicates only.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vec.h"
#include "io/meshes/corner_tree.h"

namespace crumple::io {

class Triangulator {
   public:
    /// Cuts the polygon of these n corners, four or more. Fills the empty `ears` with 3 (n - 2) numbers of corners, or
    /// leaves it empty if the fan will do. False if the polygon crosses itself, which the fan then has to do for.
    /// Points may repeat, as where a slit joins a hole to the outline. O(n log n) as a rule, O(n^2) at worst.
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
    int axis_ = 2;          ///< seen along this axis
    int sign_ = 1;          ///< 1 if the corners run counter-clockwise then, else -1
    bool exact_ = true;     ///< expansions hold the products of all coordinates
    bool touches_ = false;  ///< the outline meets itself other than at corners that follow each other
    CornerTree not_convex_;
    std::vector<int> before_, after_;  ///< of each corner that is left, the corners beside it
    std::vector<std::int8_t> turns_;   ///< of each corner: 1 convex, 0 straight, -1 reflex; 2 once cut off
    std::vector<Box> boxes_;           ///< of edges, later of triangles, from the left
};

}  // namespace crumple::io
