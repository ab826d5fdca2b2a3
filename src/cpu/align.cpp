#include "cpu/align.h"

#include <algorithm>

#include "geometry/eigen.h"

namespace crumple::cpu {

LeafFrame leaf_frame(const Array<Ball>& balls, const LeafMembers& members) {
    const std::int64_t samples = std::min<std::int64_t>(members.size(), 128);
    const auto ball = [&](std::int64_t i) -> const Ball& {
        return balls[members.triangle[i * members.size() / samples]];
    };
    const auto centroid = [&](std::int64_t i) { return Vec3d{ball(i).x, ball(i).y, ball(i).z}; };

    const double share = 1.0 / static_cast<double>(samples);
    Vec3d mean;
    double radius = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        mean = mean + share * centroid(i);
        radius += share * ball(i).r;
    }
    SymmetricMatrix covariance;
    double spread = 0;
    for (std::int64_t i = 0; i < samples; ++i) {
        const Vec3d d = centroid(i) - mean;
        covariance.xx += share * d.x * d.x;
        covariance.xy += share * d.x * d.y;
        covariance.xz += share * d.x * d.z;
        covariance.yy += share * d.y * d.y;
        covariance.yz += share * d.y * d.z;
        covariance.zz += share * d.z * d.z;
        spread = std::max(spread, largest(abs(d)));
    }
    const PrincipalAxes axes = principal_axes(covariance);
    LeafFrame frame;
    const auto to_float = [](Vec3d p) {
        return Vec3f{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    };
    frame.origin = to_float(mean);
    for (int i = 0; i < 3; ++i) frame.axis[i] = to_float(axes.axis[i]);
    frame.big = static_cast<float>(2 * (spread + radius)) + 1e-30f;
    return frame;
}

}  // namespace crumple::cpu
