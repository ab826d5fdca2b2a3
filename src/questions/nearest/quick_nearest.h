#pragma once

// Where two triangles are about closest, in float64, and what that proves of their distance. docs/nearest.md has the
// bounds; the guesses and their errors are those of near/closest_guess.h. Host only.

#include <cmath>
#include <cstdint>
#include <limits>

#include "questions/nearest/triangle_features.h"
#include "questions/near/closest_guess.h"

namespace crumple {

class QuickNearest {
   public:
    QuickNearest(const TrianglePoints& a, const TrianglePoints& b) {
        double least = std::numeric_limits<double>::infinity(), size = 0;
        Vec3d g;
        for (std::size_t k = 0; k < triangle_features; ++k) {
            const detail::Differences d(features_of_triangles(a, b, k));
            if (!(d.size <= detail::largest_size)) return;
            const detail::Guess guess = detail::guess_closest(d);
            const Vec3d difference = d.w + guess.s * d.u + guess.t * d.v;
            const double squared = dot(difference, difference);
            if (!(squared < least)) continue;
            least = squared, g = difference, size = d.size;
            feature_ = k, type_ = guess.type;
        }
        // Of a vertex of the first triangle and a point of the second, the difference is that of the second.
        direction_ = feature_ < 3 ? -1.0 * g : g;
        bound(a, b, size);
    }

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
    /// Squares of larger numbers do not underflow.
    static constexpr double least_squared = 0x1p-1000;

    void bound(const TrianglePoints& a, const TrianglePoints& b, double size) {
        const double squared = dot(direction_, direction_), length = std::sqrt(squared);
        upper_ = ((1 + 16 * epsilon) * length + 0x1p-500 + 8 * epsilon * size) * (1 + 8 * epsilon);
        if (squared < least_squared) return;
        // How far the first triangle reaches back along the direction, and the second one forth.
        const Vec3d across = a[0] - b[0], a1 = a[1] - a[0], a2 = a[2] - a[0], b1 = b[1] - b[0], b2 = b[2] - b[0];
        const double back = min(0.0, min(dot(direction_, a1), dot(direction_, a2)));
        const double forth = max(0.0, max(dot(direction_, b1), dot(direction_, b2)));
        const double whole = detail::length_1(across) + detail::length_1(a1) + detail::length_1(a2) +
                             detail::length_1(b1) + detail::length_1(b2);
        const double error = 8 * epsilon * largest(abs(direction_)) * whole + detail::near_slack;
        const double gap = (dot(direction_, across) + (back - forth)) - error;
        if (!(gap > 0)) return;
        lower_ = gap / length * (1 - 16 * epsilon);
        error_ = std::sqrt(max(0.0, upper_ - lower_) * (upper_ + lower_)) * (1 + 8 * epsilon) + 8 * epsilon * size;
    }

    double upper_ = std::numeric_limits<double>::infinity(), lower_ = 0, error_ = upper_;
    Vec3d direction_;
    std::size_t feature_ = 0;
    std::uint8_t type_ = 0;
};

}  // namespace crumple
