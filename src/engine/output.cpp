#include "engine/output.h"

#include <algorithm>

namespace crumple {

void index_pairs(const Scene& scene, Collisions& result) {
    const auto first = static_cast<std::size_t>(scene.triangles[0]);
    result.offsets.assign(first + 1, 0);
    result.hit.assign(first, 0);
    result.hit_second.assign(static_cast<std::size_t>(scene.triangles[1]), 0);
    Array<std::uint8_t>& other = scene.between ? result.hit_second : result.hit;
    for (const Pair& pair : result.pairs) {
        ++result.offsets[static_cast<std::size_t>(pair.a) + 1];
        result.hit[static_cast<std::size_t>(pair.a)] = 1;
        other[static_cast<std::size_t>(pair.b)] = 1;
    }
    for (std::size_t i = 0; i < first; ++i) result.offsets[i + 1] += result.offsets[i];
}

void keep_owned(const Scene& scene, const Levels& levels, Collisions& result) {
    const std::int64_t second = scene.between ? scene.triangles[0] : 0;
    const auto foreign = [&](Pair pair) { return !levels.own(pair.a, second + pair.b); };
    const auto end = std::remove_if(result.pairs.begin(), result.pairs.end(), foreign);
    result.pairs.resize(static_cast<std::size_t>(end - result.pairs.begin()));
    index_pairs(scene, result);
}

}  // namespace crumple
