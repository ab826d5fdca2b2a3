#pragma once

// Which of a scene's public parts a triangle belongs to. Compiled for host and device, and the same on both, so that
// parts may be answered anywhere.

#include <cstdint>

#include "geometry/normaliser.h"
#include "geometry/triangle.h"
#include "model/fuzzy_c_means.h"

namespace crumple {

/// The centres of a scene's parts, normalised, and how far they are apart.
struct PartCentres {
    std::size_t count = 0;
    Vec3d centre[max_clusters];
    double apart[max_clusters][max_clusters];

    CRUMPLE_HD void measure(std::size_t k) {
        for (std::size_t j = 0; j < count; ++j)
            apart[k][j] = std::sqrt(dot(centre[k] - centre[j], centre[k] - centre[j]));
    }
};

/// Bit k: the triangle may hold a point that is nearest to centre k.
CRUMPLE_HD inline std::uint64_t part_mask(const Triangle& triangle, const Normaliser& normalise,
                                          const PartCentres& centres) {
    const Vec3d p[3] = {normalise(triangle.point[0]), normalise(triangle.point[1]), normalise(triangle.point[2])};
    const Vec3d c = (1.0 / 3.0) * (p[0] + p[1] + p[2]);
    double r2 = 0;
    for (const Vec3d& corner : p) r2 = max(r2, dot(corner - c, corner - c));
    const double r = std::sqrt(r2);

    const auto distance2 = [&](std::size_t k) { return dot(c - centres.centre[k], c - centres.centre[k]); };
    std::size_t nearest = 0;
    double least = distance2(0);
    for (std::size_t k = 1; k < centres.count; ++k) {
        const double d2 = distance2(k);
        if (d2 < least) nearest = k, least = d2;
    }
    // The bisector rule of docs/subdivide.md. Each side is some ten roundings from the truth, and no number exceeds
    // 12 (1 + d2), so the slack covers them; `not greater` keeps a member where a comparison is with NaN.
    std::uint64_t mask = 0;
    for (std::size_t k = 0; k < centres.count; ++k) {
        const double d2 = distance2(k);
        if (!(d2 - least > 2 * r * centres.apart[k][nearest] + 1e-13 * (1 + d2))) mask |= std::uint64_t{1} << k;
    }
    return mask;
}

}  // namespace crumple
