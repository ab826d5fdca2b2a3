#include "cpu/leaf_members.h"

#include <algorithm>

namespace crumple::cpu {

void LeafMembers::gather(const Scene& scene, const Subdivision& s, const Leaf& leaf) {
    const auto n = static_cast<std::size_t>(leaf.size);
    triangle.resize_discard(n + padding);
    member.resize_discard(n);
    for (std::size_t i = 0; i < n; ++i) {
        const std::int64_t m = s.member(leaf, static_cast<std::int64_t>(i));
        member[i] = static_cast<std::int32_t>(m);
        triangle[i] = s.id[static_cast<std::size_t>(m)];
    }
    std::fill_n(triangle.begin() + n, padding, n > 0 ? triangle[n - 1] : 0);
    between = scene.between;
    first_side =
        std::partition_point(triangle.begin(), triangle.begin() + n, [&](auto t) { return !scene.second(t); }) -
        triangle.begin();
    lower.resize_discard(n);
    record.resize_discard(n + padding);
    boxes.resize(n);
}

}  // namespace crumple::cpu
