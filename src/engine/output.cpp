#include "engine/output.h"

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

}  // namespace crumple
