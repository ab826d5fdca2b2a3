#include "backends/cpu/stages/align.h"

#include <algorithm>
#include <cmath>

#include "geometry/edge_moment.h"

namespace crumple::cpu {
namespace {

/// Returns a frame whose first axis is the sweep direction of the options, which is not pca.
PrincipalAxes axes_along(const Method& method) {
    const auto& [x, y, z] = method.direction;
    Vec3d along{x, y, z};
    if (method.sweep != SweepDirection::given)
        along = {method.sweep == SweepDirection::x ? 1.0 : 0.0, method.sweep == SweepDirection::y ? 1.0 : 0.0,
                 method.sweep == SweepDirection::z ? 1.0 : 0.0};
    // Exact scaling by a power of two, so that no square overflows or underflows.
    const int exponent = std::ilogb(largest(abs(along)));
    for (int i = 0; i < 3; ++i) along[i] = std::ldexp(along[i], -exponent);
    along = (1 / std::sqrt(dot(along, along))) * along;
    const Vec3d size = abs(along);
    Vec3d across;  // coordinate axis that is farthest from `along`
    across[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1;
    Vec3d second = across - dot(across, along) * along;
    second = (1 / std::sqrt(dot(second, second))) * second;
    return {{along, second, cross(along, second)}, {}};
}

}  // namespace

LeafFrame leaf_frame(const Array<Ball>& balls, const PointRows& points, const std::int32_t* corners,
                     const LeafMembers& members, const Method& method) {
    constexpr std::int64_t most_samples = 128, edges_every = 4;
    const std::int64_t samples = std::min<std::int64_t>(members.size(), most_samples);
    const auto triangle = [&](std::int64_t i) { return members.triangle[i * members.size() / samples]; };
    const auto ball = [&](std::int64_t i) -> const Ball& { return balls[triangle(i)]; };
    const auto centroid = [&](std::int64_t i) { return Vec3d{ball(i).x, ball(i).y, ball(i).z}; };
    const auto corner = [&](std::int64_t i) { return corners + 3 * static_cast<std::int64_t>(triangle(i)); };

    const double share = 1.0 / static_cast<double>(samples);
    Vec3d mean;
    double radius = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        if (i % edges_every == 0) __builtin_prefetch(corner(i));  // indices are scattered in memory, as vertices are
        mean = mean + share * centroid(i);
        radius += share * ball(i).r;
    }
    SymmetricMatrix covariance;
    double spread = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        if (i % edges_every == 0)
            for (int k = 0; k < 3; ++k) points.prefetch(corner(i)[k]);
        const Vec3d d = centroid(i) - mean;
        covariance.xx += share * d.x * d.x;
        covariance.xy += share * d.x * d.y;
        covariance.xz += share * d.x * d.z;
        covariance.yy += share * d.y * d.y;
        covariance.yz += share * d.y * d.z;
        covariance.zz += share * d.z * d.z;
        spread = std::max(spread, largest(abs(d)));
    }
    PrincipalAxes axes = method.sweep == SweepDirection::pca ? principal_axes(covariance) : axes_along(method);
    EdgeMoment moment;
    for (std::int64_t i = 0; i < samples; i += edges_every)
        moment.add_triangle(points[corner(i)[0]], points[corner(i)[1]], points[corner(i)[2]], axes);
    turn_to_edges(axes, moment);
    LeafFrame frame;
    frame.origin = to_float(mean);
    for (int i = 0; i < 3; ++i) frame.axis[i] = to_float(axes.axis[i]);
    frame.big = static_cast<float>(2 * (spread + radius)) + 1e-30f;
    return frame;
}

Vec3f mean_motion(const PointRows& points, const std::int32_t* corners, std::int64_t ends, const LeafMembers& members) {
    if (ends == 0) return {};
    constexpr std::int64_t most_samples = 32;
    const std::int64_t samples = std::min<std::int64_t>(members.size(), most_samples);
    Vec3d sum;
    for (std::int64_t i = 0; i < samples; ++i) {
        const std::int32_t vertex = corners[3 * std::int64_t{members.triangle[i * members.size() / samples]}];
        sum = sum + (points[static_cast<std::int32_t>(vertex + ends)] - points[vertex]);
    }
    return to_float((1.0 / static_cast<double>(samples)) * sum);
}

}  // namespace crumple::cpu
