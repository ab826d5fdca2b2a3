#include "exact/proximity/nearest_parts.h"

#include "geometry/vec.h"

namespace crumple {
namespace {

using detail::Vec3dw;

// Bound on the rounding errors of perpendicular() and side(), as an angle times the sine between the directions.
// Vectors have lengths of at least 1/2, and coordinates of at most 1. A coordinate of a cross product of double words
// has an error below 2^-101, so its direction one below 2^-98 over the sine; the second product quadruples this.
constexpr double rounding = 0x1p-94;

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

/// Vector in units of 2^exponent. Its largest coordinate is at least 1/2 and below 1, if it is neither 0 nor infinite.
struct ScaledVector {
    Vec3dw vector;
    int exponent = 0;

    explicit ScaledVector(const Vec3dw& v) : vector(v) {
        const double size = largest(abs(detail::high(v)));
        if (!(size > 0) || !std::isfinite(size)) return;
        std::frexp(size, &exponent);
        for (int axis = 0; axis < 3; ++axis)
            vector[axis] = {std::ldexp(v[axis].high, -exponent), std::ldexp(v[axis].low, -exponent)};
    }
};

Vec3d unit(const Vec3dw& v) {
    const Vec3d high = detail::high(v);
    const double size = length(high);
    return size > 0 ? (1 / size) * high : Vec3d{};
}

}  // namespace

PartDirections::PartDirections(const NearestParts& parts, const std::array<Vec3d, 4>& points, double blur) {
    double sine = 1;
    tilt_ = rounding;
    for (const NearestPart* part : {&parts.first, &parts.second}) {
        for (std::size_t i = 1; i < part->points; ++i) {
            const ScaledVector along(detail::exact_difference(points[part->point[i]], points[part->point[0]]));
            along_[count_++] = along.vector;
            tilt_ += 4 * blur / std::ldexp(length(detail::high(along.vector)), along.exponent);
        }
    }
    if (count_ == 2) {
        across_ = cross(along_[0], along_[1]);
        sine = length(detail::high(across_)) / (length(detail::high(along_[0])) * length(detail::high(along_[1])));
        across_ = ScaledVector(across_).vector;
    }
    tilt_ /= sine;
}

Vec3d PartDirections::perpendicular(const Vec3dw& v, double scale, double error) const {
    if (count_ == 2) return static_cast<double>(side(v, scale, error)) * across();
    const ScaledVector scaled(v);
    const Vec3dw along = along_[0];
    const Vec3dw component = count_ == 0 ? scaled.vector : cross(along, cross(scaled.vector, along));
    const double squared = count_ == 0 ? 1 : dot(detail::high(along), detail::high(along));
    const double size = std::ldexp(length(detail::high(component)) / squared, scaled.exponent);
    return size > (error + tilt_) * scale ? unit(component) : Vec3d{};
}

int PartDirections::side(const Vec3dw& v, double scale, double error) const {
    if (count_ < 2) return 0;
    const ScaledVector scaled(v);
    const double product = detail::dot_product(across_, scaled.vector).high;
    const double size = std::ldexp(std::abs(product) / length(detail::high(across_)), scaled.exponent);
    if (!(size > (error + tilt_) * scale)) return 0;
    return product < 0 ? -1 : 1;
}

Vec3d PartDirections::across() const { return tilt_ < 0.5 ? unit(across_) : Vec3d{}; }

}  // namespace crumple
