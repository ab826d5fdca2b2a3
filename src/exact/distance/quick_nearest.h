#pragma once

// Where two triangles are about closest, in float64, and what that proves of their distance. docs/nearest.md has the
// bounds; the guesses and their errors are those of near/closest_guess.h. Host only.

#include <cmath>
#include <cstdint>
#include <limits>

#include "exact/distance/triangle_features.h"
#include "exact/proximity/closest_guess.h"

namespace crumple {

/// Two triangles along any direction: what gaps between them prove.
class TriangleGap {
   public:
    TriangleGap(const TrianglePoints& a, const TrianglePoints& b)
        : across_(a[0] - b[0]), a1_(a[1] - a[0]), a2_(a[2] - a[0]), b1_(b[1] - b[0]), b2_(b[2] - b[0]) {
        using detail::length_1;
        size_ = length_1(across_) + length_1(a1_) + length_1(a2_) + length_1(b1_) + length_1(b2_);
    }

    /// More than the largest difference between two of the points.
    double size() const { return size_; }

    /// How far the first triangle is beyond the second one along g, times the length of g; and how far that may be off.
    struct Along {
        double gap, error;
    };
    Along along(const Vec3d& g) const {
        const double back = min(0.0, min(dot(g, a1_), dot(g, a2_))), forth = max(0.0, max(dot(g, b1_), dot(g, b2_)));
        return {dot(g, across_) + (back - forth),
                8 * detail::near_epsilon * largest(abs(g)) * size_ + detail::near_slack};
    }
    /// The distance is certainly at least this, by any g; 0: nothing is known, and above 0 the triangles do not
    /// intersect.
    double lower(const Vec3d& g) const {
        const auto [gap, error] = along(g);
        return lower(gap, error, dot(g, g));
    }
    static double lower(double gap, double error, double squared) {
        // Squares of smaller numbers underflow.
        constexpr double least_squared = 0x1p-1000;
        if (!(gap > error) || squared < least_squared) return 0;
        return (gap - error) / std::sqrt(squared) * (1 - 16 * detail::near_epsilon);
    }

   private:
    Vec3d across_, a1_, a2_, b1_, b2_;
    double size_;
};

class QuickNearest {
   public:
    /// `gap`: of these triangles. Ends as soon as they are certainly farther apart than `enough`; then `lower` is above
    /// that, and all else is unknown.
    QuickNearest(const TrianglePoints& a, const TrianglePoints& b, const TriangleGap& gap,
                 double enough = std::numeric_limits<double>::infinity()) {
        if (!(gap.size() <= detail::largest_size / 4)) return;
        double least = std::numeric_limits<double>::infinity(), size = 0;
        for (std::size_t k = 0; k < triangle_features; ++k) {
            const detail::Differences d(features_of_triangles(a, b, k));
            const detail::Guess guess = detail::guess_closest(d);
            // Of a vertex of the first triangle and a point of the second, it is that of the second.
            const double sign = k < 3 ? -1 : 1;
            const Vec3d g = sign * (d.w + guess.s * d.u + guess.t * d.v);
            const double squared = dot(g, g);
            if (!(squared < least)) continue;
            least = squared, size = d.size;
            direction_ = g, feature_ = k, type_ = guess.type;
            const auto [along, error] = gap.along(g);
            lower_ = max(lower_, TriangleGap::lower(along, error, squared));
            if (lower_ > enough) return;
            if (squared - along <= 2 * error) break;  // no other features are closer but by rounding errors
        }
        const double length = std::sqrt(least);
        upper_ = ((1 + 16 * epsilon) * length + 0x1p-500 + 8 * epsilon * size) * (1 + 8 * epsilon);
        if (lower_ > 0)
            error_ = std::sqrt(max(0.0, upper_ - lower_) * (upper_ + lower_)) * (1 + 8 * epsilon) + 8 * epsilon * size;
    }
    QuickNearest(const TrianglePoints& a, const TrianglePoints& b) : QuickNearest(a, b, TriangleGap(a, b)) {}

    /// The distance is certainly at most `upper` and at least `lower`; infinite and 0 where nothing is known. Above a
    /// `lower` of 0 the triangles do not intersect.
    double upper() const { return upper_; }
    double lower() const { return lower_; }

    /// The pair of features that is closest, and which parts of it (ClosestPoints::type); both may be a little wrong.
    std::size_t feature() const { return feature_; }
    std::uint8_t type() const { return type_; }
    /// From the second triangle's point to the first one's.
    const Vec3d& direction() const { return direction_; }
    /// How far that may be from the difference of the points where those parts are closest.
    double error() const { return error_; }

   private:
    static constexpr double epsilon = detail::near_epsilon;

    double upper_ = std::numeric_limits<double>::infinity(), lower_ = 0, error_ = upper_;
    Vec3d direction_;
    std::size_t feature_ = 0;
    std::uint8_t type_ = 0;
};

}  // namespace crumple
