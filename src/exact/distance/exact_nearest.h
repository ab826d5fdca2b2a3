#pragma once

// Distance of two triangles as closed sets of points, and their closest points, in exact arithmetic for every finite
// float64 coordinate: the reference for all faster versions, and their fallback. Host only.

#include <array>
#include <cstdint>
#include <optional>

#include "exact/distance/triangle_features.h"
#include "exact/proximity/rational_distance.h"

namespace crumple {

/// One point of each triangle, rounded to the nearest float64, ties to even; +0 for zero.
using Witnesses = std::array<Vec3d, 2>;

/// Returns the sign of the distance x minus the distance y.
int compare(const RationalDistance& x, const RationalDistance& y);

/// Returns the closest points of two features, that of the first one first. `distance` must be that of these features.
Witnesses closest_points(const Features& features, const RationalDistance& distance);

class RationalNearest {
   public:
    /// Computes the distance of any two triangles. Cost: about 100 us for ordinary coordinates.
    RationalNearest(const TrianglePoints& a, const TrianglePoints& b);

    /// Computes the distance of two triangles that do not intersect. `features`: one bit for each pair of features;
    /// those of all closest pairs must be set. Cost: some microseconds for each bit that is set.
    RationalNearest(const TrianglePoints& a, const TrianglePoints& b, std::uint16_t features);

    bool touching() const { return !distance_; }
    /// Returns the sign of the distance x minus the distance y.
    friend int compare(const RationalNearest& x, const RationalNearest& y);
    /// True if the distance is at most `radius`, which is 0 or more.
    bool within(double radius) const { return touching() || distance_->within({radius, 0}); }
    double squared() const { return touching() ? 0 : distance_->squared(); }
    /// Returns the closest points, those of the first closest pair of features. If the triangles intersect, both are
    /// the lexicographically smallest point of the intersection.
    Witnesses points() const;

   private:
    void find_least(const TrianglePoints& a, const TrianglePoints& b, std::uint16_t features);

    std::optional<RationalDistance> distance_;  ///< least distance of features; none if the triangles intersect
    Features features_;
    bool second_first_ = false;
    Vec3d common_;  ///< closest point if the triangles intersect
};

}  // namespace crumple
