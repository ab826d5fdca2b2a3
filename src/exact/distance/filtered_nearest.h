#pragma once

// Float64 filter: guesses the closest points of two triangles, and proves bounds on their distance. The bounds are
// derived in docs/nearest.md; the guesses and their errors are those of proximity/closest_guess.h. Host only.

#include <cmath>
#include <cstdint>
#include <limits>

#include "exact/distance/triangle_features.h"
#include "exact/proximity/closest_guess.h"

namespace crumple {

/// Gap between two triangles along a direction, and the lower bound on their distance that it proves.
class TriangleGap {
   public:
    TriangleGap(const TrianglePoints& a, const TrianglePoints& b)
        : across_(a[0] - b[0]), a1_(a[1] - a[0]), a2_(a[2] - a[0]), b1_(b[1] - b[0]), b2_(b[2] - b[0]) {
        using detail::length_1;
        size_ = length_1(across_) + length_1(a1_) + length_1(a2_) + length_1(b1_) + length_1(b2_);
    }

    /// Returns an upper bound, up to rounding, on |x| + |y| + |z| of the difference of any two of the six corners.
    double size() const { return size_; }

    /// Gap from the second triangle to the first along g, times the length of g, and a bound on the error of this
    /// product.
    struct Along {
        double gap, error;
    };
    Along along(const Vec3d& g) const {
        const double back = min(0.0, min(dot(g, a1_), dot(g, a2_))), forth = max(0.0, max(dot(g, b1_), dot(g, b2_)));
        return {dot(g, across_) + (back - forth),
                8 * detail::near_epsilon * largest(abs(g)) * size_ + detail::near_slack};
    }
    /// Returns a lower bound on the distance, for any g; 0 if g proves nothing. Above 0, the triangles do not
    /// intersect.
    double lower(const Vec3d& g) const {
        const auto [gap, error] = along(g);
        return lower(gap, error, dot(g, g));
    }
    static double lower(double gap, double error, double squared) {
        // Smaller squares may have lost digits to underflow.
        constexpr double least_squared = 0x1p-1000;
        if (!(gap > error) || squared < least_squared) return 0;
        return (gap - error) / std::sqrt(squared) * (1 - 16 * detail::near_epsilon);
    }

   private:
    Vec3d across_, a1_, a2_, b1_, b2_;
    double size_;
};

class FilteredNearest {
   public:
    /// `gap` must be that of these triangles. Stops as soon as they are certainly farther apart than `enough`; then
    /// lower() exceeds `enough`, direction() proves it, and all other results are undefined.
    FilteredNearest(const TrianglePoints& a, const TrianglePoints& b, const TriangleGap& gap,
                    double enough = std::numeric_limits<double>::infinity()) {
        if (!(gap.size() <= detail::largest_size / 4)) return;
        double least = std::numeric_limits<double>::infinity(), size = 0;
        for (std::size_t k = 0; k < triangle_features; ++k) {
            const detail::Differences d(features_of_triangles(a, b, k));
            const detail::Guess guess = detail::guess_closest(d);
            // For a vertex of the first triangle, the difference points from it to the second triangle.
            const double sign = k < 3 ? -1 : 1;
            const Vec3d g = sign * (d.w + guess.s * d.u + guess.t * d.v);
            const double squared = dot(g, g);
            if (!(squared < least)) continue;
            least = squared, size = d.size;
            direction_ = g, feature_ = k, type_ = guess.type;
            const auto [along, error] = gap.along(g);
            lower_ = max(lower_, TriangleGap::lower(along, error, squared));
            if (lower_ > enough) return;
            if (squared - along <= 2 * error) break;  // no other features are closer, except by rounding errors
        }
        const double length = std::sqrt(least);
        upper_ = ((1 + 16 * epsilon) * length + 0x1p-500 + 8 * epsilon * size) * (1 + 8 * epsilon);
        if (lower_ > 0)
            error_ = std::sqrt(max(0.0, upper_ - lower_) * (upper_ + lower_)) * (1 + 8 * epsilon) + 8 * epsilon * size;
    }
    FilteredNearest(const TrianglePoints& a, const TrianglePoints& b) : FilteredNearest(a, b, TriangleGap(a, b)) {}

    /// Bounds on the distance: at least lower() and at most upper(); 0 and infinite if nothing is proven. If lower() is
    /// above 0, the triangles do not intersect.
    double upper() const { return upper_; }
    double lower() const { return lower_; }

    /// Returns the closest pair of features (features_of_triangles()), and its ClosestPoints::type. Both may be
    /// slightly wrong.
    std::size_t feature() const { return feature_; }
    std::uint8_t type() const { return type_; }
    /// Returns the vector from the guessed closest point of the second triangle to that of the first.
    const Vec3d& direction() const { return direction_; }
    /// Returns a bound on the length of the difference between direction() and the exact vector between the triangles'
    /// closest points; infinite if nothing is proven.
    double error() const { return error_; }

   private:
    static constexpr double epsilon = detail::near_epsilon;

    double upper_ = std::numeric_limits<double>::infinity(), lower_ = 0, error_ = upper_;
    Vec3d direction_;
    std::size_t feature_ = 0;
    std::uint8_t type_ = 0;
};

}  // namespace crumple
