#include "pipeline/part.h"

#include <algorithm>
#include <cmath>

#include "pipeline/fuzzy_c_means.h"
#include "pipeline/normaliser.h"

namespace crumple {

void part_masks(const Scene& scene, const std::vector<std::array<double, 3>>& centres, Array<std::uint64_t>& masks) {
    const Normaliser normalise(scene.low, scene.high);
    const std::size_t count = centres.size();
    std::array<Vec3d, max_clusters> v;
    for (std::size_t k = 0; k < count; ++k) v[k] = normalise({centres[k][0], centres[k][1], centres[k][2]});

    masks.resize_discard(static_cast<std::size_t>(scene.triangle_count()));
    for (std::int64_t t = 0; t < scene.triangle_count(); ++t) {
        const Triangle triangle = scene.triangle(t);
        const std::array<Vec3d, 3> p{normalise(triangle.point[0]), normalise(triangle.point[1]),
                                     normalise(triangle.point[2])};
        const Vec3d c = (1.0 / 3.0) * (p[0] + p[1] + p[2]);
        double r2 = 0;
        for (const Vec3d& corner : p) r2 = max(r2, dot(corner - c, corner - c));
        const double r = std::sqrt(r2);

        std::array<double, max_clusters> d2;
        std::size_t nearest = 0;
        for (std::size_t k = 0; k < count; ++k) {
            d2[k] = dot(c - v[k], c - v[k]);
            if (d2[k] < d2[nearest]) nearest = k;
        }
        // The bisector rule of docs/subdivide.md. Each side is some ten roundings from the truth, and no number exceeds
        // 12 (1 + d2), so the slack covers them; `not greater` keeps a member where a comparison is with NaN.
        std::uint64_t mask = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const double between = std::sqrt(dot(v[k] - v[nearest], v[k] - v[nearest]));
            if (!(d2[k] - d2[nearest] > 2 * r * between + 1e-13 * (1 + d2[k]))) mask |= std::uint64_t{1} << k;
        }
        masks[static_cast<std::size_t>(t)] = mask;
    }
}

std::vector<Part> make_parts(const Scene& scene, int count) {
    // A cold start on at most 4,096 centroids, with the usual fuzziness 2: no call of pow(), whose last bit may differ.
    const Normaliser normalise(scene.low, scene.high);
    const auto triangles = static_cast<std::size_t>(scene.triangle_count());
    const std::size_t samples = std::min<std::size_t>(triangles, 4096);
    std::vector<Vec3f> points(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        const Triangle t = scene.triangle(static_cast<std::int64_t>(i * triangles / samples));
        const Vec3d c = (1.0 / 3.0) * (normalise(t.point[0]) + normalise(t.point[1]) + normalise(t.point[2]));
        points[i] = {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)};
    }
    Centres centres;
    centres.count = count;
    const auto point = [&](std::size_t i) { return points[i]; };
    if (samples > 0) {
        start_centres(count, samples, point, centres);
        fuzzy_c_means(samples, point, {.fuzziness = 2, .iterations = 30, .stop = 1e-4}, centres);
    }

    std::vector<Part> parts(static_cast<std::size_t>(count));
    std::vector<std::array<double, 3>> positions;
    for (int k = 0; k < count; ++k) {
        const Vec3f c = centres[k];
        const Vec3d p = normalise.inverse({c.x, c.y, c.z});
        positions.push_back({p.x, p.y, p.z});
    }
    Array<std::uint64_t> masks;
    part_masks(scene, positions, masks);
    for (int k = 0; k < count; ++k) {
        Part& part = parts[static_cast<std::size_t>(k)];
        part.index = k;
        part.centres = positions;
        for (std::size_t t = 0; t < triangles; ++t) {
            if (!(masks[t] >> k & 1)) continue;
            if (scene.second(static_cast<std::int64_t>(t)))
                part.triangles_second.push_back(
                    static_cast<std::int32_t>(t - static_cast<std::size_t>(scene.triangles[0])));
            else
                part.triangles.push_back(static_cast<std::int32_t>(t));
        }
    }
    return parts;
}

}  // namespace crumple
