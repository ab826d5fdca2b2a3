#pragma once

// The distance of two triangles as sets, and where they are closest, in exact arithmetic for every finite float64
// coordinate: the yardstick for everything faster, and what that falls back on. Host only.

#include <array>
#include <cstdint>
#include <optional>

#include "exact/distance/triangle_features.h"
#include "exact/proximity/rational_distance.h"

namespace crumple {

/// A point of each triangle, rounded to the nearest float64, ties to even; +0 for zero.
using Witnesses = std::array<Vec3d, 2>;

/// The sign of the difference of two squared distances.
int compare(const RationalDistance& x, const RationalDistance& y);

/// Where two features are closest: the first one's point, and the second one's.
Witnesses closest_points(const Features& features, const RationalDistance& distance);

class RationalNearest {
   public:
    /// Cost: some 100 us for ordinary coordinates.
    RationalNearest(const TrianglePoints& a, const TrianglePoints& b);

    /// The same of two triangles that do not intersect. `features`: a bit for each pair of features, of which those
    /// that are closest must be set; others need not. Cost: some microseconds for each that is set.
    RationalNearest(const TrianglePoints& a, const TrianglePoints& b, std::uint16_t features);

    bool touching() const { return !distance_; }
    /// The sign of the difference of two distances.
    friend int compare(const RationalNearest& x, const RationalNearest& y);
    /// Whether the distance is at most the radius, 0 or more.
    bool within(double radius) const { return touching() || distance_->within({radius, 0}); }
    double squared() const { return touching() ? 0 : distance_->squared(); }
    /// Of several pairs of points those of the first pair of features. Of triangles that intersect the
    /// lexicographically smallest point of the intersection, twice.
    Witnesses points() const;

   private:
    void find_least(const TrianglePoints& a, const TrianglePoints& b, std::uint16_t features);

    std::optional<RationalDistance> distance_;  ///< of the first closest features; none: the triangles intersect
    Features features_;
    bool second_first_ = false;
    Vec3d common_;  ///< of triangles that intersect
};

}  // namespace crumple
