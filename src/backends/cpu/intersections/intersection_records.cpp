#include "backends/cpu/intersections/intersection_records.h"

namespace crumple::cpu {
namespace {

// Record for rows without a member. The plane filter drops it: with the normal 0 and c = -2, every point certainly lies
// above its plane.
constexpr Record no_triangle{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {-1, -1, -1}, -2};

}  // namespace

void LeafRecords::build(const IntersectKernels& kernels, const BuildInput& input, LeafMembers& members) {
    built.resize_discard(static_cast<std::size_t>(input.members + padding));
    kernels.build(input, built.data(), members.boxes, members.bounds);
    reach = members.bounds.reach;
    stars.find(input, members);
}

void LeafRecords::sort(const IntersectKernels& kernels, const SortedLeaf& leaf) {
    sorted.resize_discard(static_cast<std::size_t>(leaf.rows + padding));
    for_each_dummy(leaf, [&](std::int64_t row) { sorted[row] = no_triangle; });
    kernels.scatter(built.data(), leaf.members, leaf.position.data(), plane_scale(reach), sorted.data());
    stars.sort(leaf);
}

}  // namespace crumple::cpu
