#pragma once

// Fuzzy C-means on a sample of points (sec. 4, eqs. 2 to 4 of [MZ], the paper cited in ARCHITECTURE.md).
//
// One iteration computes the membership of each point in each cluster (eq. 3) and moves each centre to the mean of the
// points weighted by membership^t (eq. 4). With distances d_k of the point from the centres, the memberships are u_k =
// d_k^p / sum_j d_j^p, p = -2 / (t - 1). For t = 2, the usual choice, both exponents, p and t, are integers. 1e-30 is
// added to each squared distance, so a point on a centre counts as one at a distance of 1e-15. Iteration ends when no
// coordinate of a centre moved by more than `stop`, or after `iterations`. Searches are correct with any centres, which
// affect only speed. So the sample and the number of iterations may be small ([MZ] sec. 4, end).
//
// Points and centres are normalised (at most about 1). Inner loops run over clusters, whose sums are independent, so
// that every compiler and machine gives the same centres.

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

inline constexpr int max_clusters =
    64;  ///< most clusters that one cluster is divided into: a mask has one bit for each

/// Cluster centres of one subdivision, cached from frame to frame for warm starts.
struct Centres {
    int count = 0;
    std::array<float, max_clusters> x{}, y{}, z{};

    Vec3f operator[](std::integral auto k) const { return {x.data()[k], y.data()[k], z.data()[k]}; }
    void set(std::integral auto k, Vec3f p) { x.data()[k] = p.x, y.data()[k] = p.y, z.data()[k] = p.z; }
};

/// True if splitting `members` triangles into `clusters` overlapping clusters makes sweeps cheaper: if each triangle
/// joins at most 1.1 clusters^(1/3) of them on average. `memberships`: number of pairs of a cluster and a triangle in
/// it. Reason: a sweep costs members^2 times the ratio of the mean interval to the extent, and the extent of one of k
/// clusters is k^(1/3) times smaller than that of the scene.
inline bool splitting_pays(double memberships, double members, int clusters) {
    return memberships <= 1.1 * std::cbrt(clusters) * members;
}

struct FuzzyOptions {
    double fuzziness = 2;  ///< the exponent t above, > 1
    int iterations = 2;
    double stop = 0;  ///< largest movement of a centre, in normalised coordinates, that ends the iteration
};

/// Starts `count` centres on points spread evenly over the sample's order.
template <class Point>
void start_centres(int count, std::size_t samples, Point&& point, Centres& centres) {
    centres.count = count;
    const auto n = static_cast<std::size_t>(count);
    for (std::size_t k = 0; k < n; ++k) centres.set(k, point((2 * k + 1) * samples / (2 * n)));
}

/// Iterates from the given `centres`, and replaces them. point(0) to point(samples - 1) return the sample, as Vec3f.
/// Returns the number of iterations.
template <class Point>
int fuzzy_c_means(std::size_t samples, Point&& point, const FuzzyOptions& options, Centres& centres) {
    const auto count = static_cast<std::size_t>(centres.count);
    const bool usual = options.fuzziness == 2.0;
    const auto distance_power = static_cast<float>(1.0 / (options.fuzziness - 1.0));
    const auto member_power = static_cast<float>(options.fuzziness);
    alignas(64) std::array<float, max_clusters> w, sum_w, sum_x, sum_y, sum_z;
    for (int iteration = 1; iteration <= options.iterations; ++iteration) {
        for (auto* sum : {&sum_w, &sum_x, &sum_y, &sum_z}) sum->fill(0.0f);
        for (std::size_t i = 0; i < samples; ++i) {
            const Vec3f p = point(i);
            for (std::size_t k = 0; k < count; ++k) {
                const float dx = p.x - centres.x[k], dy = p.y - centres.y[k], dz = p.z - centres.z[k];
                w[k] = 1.0f / (dx * dx + dy * dy + dz * dz + 1e-30f);
            }
            if (!usual)
                for (std::size_t k = 0; k < count; ++k) w[k] = std::pow(w[k], distance_power);
            float total = 0;
            for (std::size_t k = 0; k < count; ++k) total += w[k];
            const float scale = 1.0f / total;
            for (std::size_t k = 0; k < count; ++k) {
                const float u = w[k] * scale;
                const float weight = usual ? u * u : std::pow(u, member_power);
                sum_w[k] += weight;
                sum_x[k] += weight * p.x;
                sum_y[k] += weight * p.y;
                sum_z[k] += weight * p.z;
            }
        }
        float moved = 0;
        for (std::size_t k = 0; k < count; ++k) {
            if (!(sum_w[k] > 0)) continue;
            const Vec3f next{sum_x[k] / sum_w[k], sum_y[k] / sum_w[k], sum_z[k] / sum_w[k]};
            if (!(std::isfinite(next.x) && std::isfinite(next.y) && std::isfinite(next.z))) continue;
            moved = max(moved, largest(abs(next - centres[k])));
            centres.set(k, next);
        }
        if (moved <= static_cast<float>(options.stop)) return iteration;
    }
    return options.iterations;
}

}  // namespace crumple
