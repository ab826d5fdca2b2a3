#include "scenes/simulation/collider.h"

#include <algorithm>
#include <cmath>

#include "scenes/arithmetic.h"

namespace crumple::scenes {

Nearest MovingBall::nearest(Vec3d point) const {
    const Vec3d arm = point - centre;
    const double far = length(arm);
    const Vec3d normal = far > 0 ? (1 / far) * arm : Vec3d{0, 0, 1};
    return {far - radius, normal, velocity + growth * normal + radius * cross(spin, normal)};
}

Nearest Funnel::nearest(Vec3d point) const {
    const double r = std::sqrt(point.x * point.x + point.y * point.y);
    double best = std::numeric_limits<double>::infinity(), best_r = 0, best_z = 0;
    bool inside = true, smooth = false;
    for (std::size_t i = 0; i + 1 < profile_.size(); ++i) {
        const auto [r0, z0] = profile_[i];
        const auto [r1, z1] = profile_[i + 1];
        const double along_r = r1 - r0, along_z = z1 - z0;
        const double t = std::clamp(
            ((r - r0) * along_r + (point.z - z0) * along_z) / (along_r * along_r + along_z * along_z), 0.0, 1.0);
        const double off_r = r - (r0 + t * along_r), off_z = point.z - (z0 + t * along_z);
        const double square = off_r * off_r + off_z * off_z;
        if (square >= best) continue;
        best = square;
        best_r = off_r;
        best_z = off_z;
        inside = along_z * off_r - along_r * off_z >= 0;  // on the same side of the profile as the axis
        smooth = (t > 0 || i > 0) && (t < 1 || i + 2 < profile_.size());
    }
    double distance = std::sqrt(best);
    if (distance == 0) return {};
    if (!inside && smooth) {
        distance = -distance;
        if (distance < -wall_) return {};
    }
    const double normal_r = best_r / distance, normal_z = best_z / distance;
    const double cosine_of = r > 0 ? point.x / r : 1, sine_of = r > 0 ? point.y / r : 0;
    return {distance, {normal_r * cosine_of, normal_r * sine_of, normal_z}, {}};
}

}  // namespace crumple::scenes
