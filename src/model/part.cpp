#include "model/part.h"

#include <algorithm>
#include <cmath>

#include "geometry/normaliser.h"
#include "model/fuzzy_c_means.h"
#include "model/part_mask.h"

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

void PartSample::set(std::size_t i, const Triangle& t, const Normaliser& normalise) {
    const Vec3d c = (1.0 / 3.0) * (normalise(t.point[0]) + normalise(t.point[1]) + normalise(t.point[2]));
    centroids_[i] = {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)};
}

Part PartSample::centres(int count, const Normaliser& normalise) const {
    // A cold start with the usual fuzziness 2: no call of pow(), whose last bit may differ.
    Centres placed;
    placed.count = count;
    const auto point = [&](std::size_t i) { return centroids_[i]; };
    if (size() > 0) {
        start_centres(count, size(), point, placed);
        fuzzy_c_means(size(), point, {.fuzziness = 2, .iterations = 30, .stop = 1e-4}, placed);
    }
    Part part;
    for (int k = 0; k < count; ++k) {
        const Vec3f c = placed[k];
        const Vec3d p = normalise.inverse({c.x, c.y, c.z});
        part.centres.push_back({p.x, p.y, p.z});
    }
    return part;
}

std::vector<Part> list_members(const Part& centres, std::span<const std::uint64_t> masks, std::int64_t first_mesh) {
    std::vector<Part> parts(centres.centres.size(), centres);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        parts[k].index = static_cast<std::int32_t>(k);
        for (std::size_t i = 0; i < masks.size(); ++i) {
            if (!(masks[i] >> k & 1)) continue;
            const auto t = static_cast<std::int64_t>(i);
            if (t < first_mesh)
                parts[k].triangles.push_back(static_cast<std::int32_t>(t));
            else
                parts[k].triangles_second.push_back(static_cast<std::int32_t>(t - first_mesh));
        }
    }
    return parts;
}

std::vector<Part> make_parts(const Scene& scene, int count, ParallelFor& parallel) {
    const Normaliser normalise(scene.low, scene.high);
    PartSample sample(scene.triangle_count());
    for (std::size_t i = 0; i < sample.size(); ++i) sample.set(i, scene.triangle(sample.triangle(i)), normalise);
    const Part all = sample.centres(count, normalise);
    Array<std::uint64_t> masks;
    part_masks(scene, all, parallel, masks);
    return list_members(all, masks.span(), scene.triangles[0]);
}

}  // namespace crumple
