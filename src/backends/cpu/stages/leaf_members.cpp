#include "backends/cpu/stages/leaf_members.h"

#include <algorithm>
#include <numeric>

namespace crumple::cpu {

void LeafMembers::reserve(std::size_t n) {
    triangle.resize_discard(n + padding);
    member.resize_discard(n);
    lower.resize_discard(n);
    boxes.resize(n);
}

void LeafMembers::gather(const PreparedScene& scene, const Subdivision& s, const Leaf& leaf) {
    const auto n = static_cast<std::size_t>(leaf.size);
    reserve(n);
    if (leaf.child < 0)
        std::iota(member.begin(), member.end(), static_cast<std::int32_t>(leaf.begin));
    else
        std::copy_n(s.members2[static_cast<std::size_t>(leaf.cluster)].begin() + leaf.begin, n, member.begin());
    for (std::size_t i = 0; i < n; ++i) triangle[i] = s.id[member[i]];
    std::fill_n(triangle.begin() + n, padding, n > 0 ? triangle[n - 1] : 0);
    between = scene.between;
    first_side =
        std::partition_point(triangle.begin(), triangle.begin() + n, [&](auto t) { return !scene.second(t); }) -
        triangle.begin();
}

}  // namespace crumple::cpu
