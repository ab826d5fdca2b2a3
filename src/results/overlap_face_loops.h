#pragma once

// Position of closed chains of segments (loops) within a face of one surface. The plane of the face is projected along
// an axis. From the point of a loop with the greatest first coordinate, a ray along that coordinate meets what
// surrounds the loop there. Ties are decided by the shift of the second surface. Host only.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "exact/overlap/enclosed.h"
#include "exact/overlap/shifted_point.h"

namespace crumple {

/// Segment on the face. The inside of the other surface is to its left, seen from outside the face's surface.
struct SegmentOnFace {
    std::int32_t segment;  ///< index, for the caller
    std::int32_t chain;    ///< equal for segments that are connected within the face
    CrossedEdge start, end;
};

/// First things that a ray from a loop meets.
struct Surroundings {
    std::int32_t segment = -1;  ///< the first segment that the ray meets, or −1 if it meets none
    std::size_t edge = 0;       ///< edge of the face by which the ray leaves it
    /// Winding number next to the loop, minus that on the edge where the ray leaves the face.
    int change = 0;
    std::size_t before = 0;  ///< number of crossings of that edge between its first corner and the ray
};

class FaceLoops {
   public:
    /// `side`: surface of the face. `crossings`: those of each edge of the face, in its direction. `in_range`: true if
    /// all points are in the range of double-double arithmetic.
    FaceLoops(std::size_t side, const FaceCorners& face, std::vector<SegmentOnFace> segments,
              const std::array<std::vector<CrossedEdge>, 3>& crossings, bool in_range);

    /// Returns the surroundings of the loop that consists of the segments of a chain. Cost: O(1) for each segment of
    /// the chain, and for each one at about the height of the ray.
    Surroundings around(std::int32_t chain);

   private:
    /// Point in the plane: coordinates without the shift, if they are in range, and what is needed to compute them with
    /// the shift.
    struct Point {
        std::array<Enclosed, 2> x;
        std::optional<CrossedEdge> crossing;  ///< else it is `vertex`
        Vec3d vertex;
        mutable std::optional<ShiftedPoint> shifted = {};  ///< with the shift, once it is needed
    };

    Point at(const CrossedEdge& crossing) const;
    Point at(const Vec3d& vertex) const;
    int axis(int coordinate) const;
    int compare(int coordinate, const Point& p, const Point& q) const;
    ShiftedNumber shifted(int coordinate, const Point& p) const;
    int orientation(const Point& p, const Point& q, const Point& r) const;
    bool is_nearer(std::size_t i, std::size_t j) const;
    bool ray_meets(const Point& p, const Point& q, bool& upward) const;
    std::size_t band_at(double height) const;
    void sort_into_bands();

    std::size_t side_;
    bool in_range_;
    int dropped_ = 2;                      ///< axis of the projection
    bool mirrored_ = false;                ///< true if the projection turns the face over
    std::vector<SegmentOnFace> segments_;  ///< sorted by chain
    std::vector<Point> start_, end_;       ///< ends of each segment
    std::array<Point, 3> corner_;
    std::array<std::vector<Point>, 3> crossings_;  ///< by edge
    const Point* origin_ = nullptr;                ///< start of the ray
    // Bands of equal height. Each lists the segments that may reach it.
    double first_height_ = 0, band_height_ = 0;
    std::vector<std::vector<std::uint32_t>> bands_;
};

}  // namespace crumple
