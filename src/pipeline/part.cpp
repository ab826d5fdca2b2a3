#include "pipeline/part.h"

#include <algorithm>
#include <cmath>

#include "pipeline/fuzzy_c_means.h"
#include "pipeline/normaliser.h"
#include "pipeline/part_mask.h"

namespace crumple {

void part_masks(const Scene& scene, const Part& part, ParallelFor& parallel, Array<std::uint64_t>& masks) {
    const Normaliser normalise(scene.low, scene.high);
    PartCentres centres;
    centres.count = part.centres.size();
    for (std::size_t k = 0; k < centres.count; ++k) {
        const auto& [x, y, z] = part.centres[k];
        centres.centre[k] = normalise({x, y, z});
    }
    for (std::size_t k = 0; k < centres.count; ++k) centres.measure(k);

    const auto set_masks = [&](std::size_t count, auto triangle) {
        constexpr std::size_t batch = 1024;
        parallel.parallel_for((count + batch - 1) / batch, [&](std::size_t b) {
            for (std::size_t i = b * batch; i < std::min(count, (b + 1) * batch); ++i) {
                const std::int64_t t = triangle(i);
                masks[static_cast<std::size_t>(t)] = part_mask(scene.triangle(t), normalise, centres);
            }
        });
    };
    const auto triangles = static_cast<std::size_t>(scene.triangle_count());
    const auto &first = part.triangles, &second = part.triangles_second;
    if (first.empty() && second.empty()) {
        masks.resize_discard(triangles);
        set_masks(triangles, [](std::size_t i) { return static_cast<std::int64_t>(i); });
    } else {
        masks.assign(triangles, 0);
        set_masks(first.size(), [&](std::size_t i) { return std::int64_t{first[i]}; });
        set_masks(second.size(), [&](std::size_t i) { return scene.triangles[0] + second[i]; });
    }
}

std::vector<Part> make_parts(const Scene& scene, int count, ParallelFor& parallel) {
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
    Part all;
    for (int k = 0; k < count; ++k) {
        const Vec3f c = centres[k];
        const Vec3d p = normalise.inverse({c.x, c.y, c.z});
        all.centres.push_back({p.x, p.y, p.z});
    }
    Array<std::uint64_t> masks;
    part_masks(scene, all, parallel, masks);
    for (int k = 0; k < count; ++k) {
        Part& part = parts[static_cast<std::size_t>(k)];
        part.index = k;
        part.centres = all.centres;
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
