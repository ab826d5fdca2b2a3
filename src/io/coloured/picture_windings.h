#pragma once

// Winding numbers of points about a mesh, by a ray from each point, for pictures: in float64, not exactly.
//
// All rays have one direction, chosen so that no edge of a usual model has it. Triangles are projected along it into a
// grid of cells.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/vec.h"

namespace crumple::io {

class PictureWindings {
   public:
    /// `corners`: three indices of `points` per triangle. They must outlive the object.
    PictureWindings(std::span<const Vec3d> points, std::span<const std::int32_t> corners);

    static constexpr Vec3d direction{0.3712, 0.2153, 0.9033};

    /// Returns the winding number at a point that does not lie on the surface, except perhaps on the triangle
    /// `ignored`, which is left out. Cost: linear in the number of triangles of one grid cell.
    int at(const Vec3d& point, std::int32_t ignored = -1) const;

   private:
    std::int32_t column(double x) const { return place(x, low_.x, high_.x); }
    std::int32_t row(double y) const { return place(y, low_.y, high_.y); }
    std::int32_t place(double x, double low, double high) const;
    template <class Take>
    void for_each_cell(std::int32_t triangle, Take take) const;

    std::vector<Vec3d> points_;  ///< points in rotated coordinates: z along the rays, x and y across them
    std::span<const std::int32_t> corners_;
    Vec3d low_{}, high_{};
    std::int32_t size_ = 1;  ///< cells in a row, and in a column
    std::vector<std::size_t> first_;
    std::vector<std::int32_t> triangles_;  ///< triangles [first_[c], first_[c + 1]) meet cell c
};

}  // namespace crumple::io
