#include "cpu/leaf_members.h"

#include <algorithm>
#include <numeric>

namespace crumple::cpu {

void LeafMembers::gather(const Scene& scene, const Subdivision& s, const Leaf& leaf, const Kernels& kernels) {
    const auto n = static_cast<std::size_t>(leaf.size), k = static_cast<std::size_t>(leaf.cluster);
    triangle.resize_discard(n + padding);
    member.resize_discard(n + padding);
    if (leaf.child < 0) {
        std::copy_n(s.id.begin() + s.first[k], n, triangle.begin());
        std::iota(member.begin(), member.begin() + n, static_cast<std::int32_t>(s.first[k]));
    } else {
        kernels.list_members(s.mask2.data(), s.id.data(), s.first[k], s.first[k + 1], leaf.child, member.data(),
                             triangle.data());
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
