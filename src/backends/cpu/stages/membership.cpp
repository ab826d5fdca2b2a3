#include "backends/cpu/stages/membership.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace crumple::cpu {
namespace {

double length(const Vec3f& v) {
    const Vec3d d{v.x, v.y, v.z};
    return std::sqrt(dot(d, d));
}

/// Returns the clusters that a ball joins by a rule other than the ball by. `distance`: by cluster, the distance of
/// the ball's centre from the cluster's centre; `nearest`: the cluster with the least distance.
std::uint64_t mask_of(const SceneMembership& by, const Centres& centres, const double* distance, int nearest) {
    std::uint64_t mask = std::uint64_t{1} << nearest;
    const double least = distance[nearest];
    if (by.kind == Membership::equation_5) {
        for (int k = 0; k < centres.count; ++k) {
            // Distance of the ball's centre from the plane that bisects the two clusters' centres, times twice the
            // distance of these centres.
            const double from_plane = distance[k] * distance[k] - least * least;
            if (from_plane <= by.largest_radius * length(centres[k] - centres[nearest])) mask |= std::uint64_t{1} << k;
        }
        return mask;
    }
    // Memberships relative to that in the nearest cluster, so that no power overflows.
    const double power = 2 / (by.fuzziness - 1);
    double share[max_clusters], sum = 0;
    for (int k = 0; k < centres.count; ++k) {
        share[k] = distance[k] > 0 ? std::pow(least / distance[k], power) : 1;
        sum += share[k];
    }
    for (int k = 0; k < centres.count; ++k)
        if (share[k] >= by.threshold * sum) mask |= std::uint64_t{1} << k;
    return mask;
}

}  // namespace

SceneMembership membership_of(const Options& options, const Array<Ball>& balls, std::int64_t n,
                              const std::uint8_t* included) {
    SceneMembership by{options.method.membership, options.method.threshold, options.fuzzy_c_means.fuzziness, 0};
    if (by.kind != Membership::equation_5) return by;
    for (std::int64_t t = 0; t < n; ++t)
        if (!included || included[t]) by.largest_radius = std::max(by.largest_radius, balls[t].r);
    return by;
}

bool assign_members(const SceneMembership& by, const StageKernels& kernels, const Ball* balls, std::int64_t n,
                    const std::uint8_t* included, const Centres& centres, std::uint64_t* mask, std::int64_t* count) {
    if (by.kind == Membership::ball) {
        kernels.assign(balls, n, centres, mask, count);
        return false;
    }
    std::int64_t unused[max_clusters] = {};
    kernels.assign(balls, n, centres, mask, unused);
    bool loses = false;
    for (std::int64_t i = 0; i < n; ++i) {
        double distance[max_clusters], least = std::numeric_limits<double>::infinity();
        int nearest = 0;
        for (int k = 0; k < centres.count; ++k) {
            distance[k] = length(Vec3f{balls[i].x, balls[i].y, balls[i].z} - centres[k]);
            if (distance[k] < least) least = distance[k], nearest = k;
        }
        const std::uint64_t own = mask_of(by, centres, distance, nearest);
        loses |= (!included || included[i]) && (mask[i] & ~own) != 0;
        mask[i] = own;
        for (std::uint64_t bits = own; bits; bits &= bits - 1) ++count[std::countr_zero(bits)];
    }
    return loses;
}

}  // namespace crumple::cpu
