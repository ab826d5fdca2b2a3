#include "search/walks/tree_pair_walk.h"

namespace crumple {

void TreePairWalk::set_directions(const Vec3d& known, double distance) {
    boxes_.emplace(a_.step.start, a_.tree->frame(), b_.step.start, b_.tree->frame(), known);
    is_step_ = false;
    use_directions(distance);
}

void TreePairWalk::set_directions_of_step(double distance) {
    boxes_.emplace(a_.step, a_.tree->frame(), b_.step, b_.tree->frame());
    is_step_ = true;
    use_directions(distance);
}

void TreePairWalk::use_directions(double distance) {
    for (Side* side : {&a_, &b_}) side->forget();
    a_.boxes = &boxes_->a();
    b_.boxes = &boxes_->b();
    set_limit(distance);
}

const PosedLeaf& TreePairWalk::posed(Side& side, std::int32_t group) {
    if (side.leaves.empty()) side.leaves.resize(cached_leaves);
    const std::size_t place = static_cast<std::size_t>(group) % cached_leaves;
    PosedLeaf& leaf = side.leaves[place];
    if (side.group[place] == group) return leaf;
    side.group[place] = group;
    leaf.group = &side.tree->group(group);
    side.tree->pose(*leaf.group, side.step.start, leaf.coordinate);
    const auto count = static_cast<std::size_t>(leaf.group->count);
    find_intervals(side, *leaf.group, leaf.coordinate, leaf.reach);
    if (is_step_) {
        ShapeTree::Posed coordinate;
        PosedLeaf::Reaches end;
        side.tree->pose(*leaf.group, side.step.end, coordinate);
        find_intervals(side, *leaf.group, coordinate, end);
        for (std::size_t k = 0; k < count; ++k) leaf.reach[k].widen(end[k]);
    }
    leaf.all = leaf.reach[0];
    for (std::size_t k = 1; k < count; ++k) leaf.all.widen(leaf.reach[k]);
    return leaf;
}

void TreePairWalk::find_intervals(const Side& side, const ShapeTree::Group& group, const ShapeTree::Posed& coordinate,
                                  PosedLeaf::Reaches& reach) const {
    BoxDistance::Lanes at[3 * ShapeTree::most_elements];
    for (std::int32_t v = 0; v < group.vertices; ++v)
        at[v] = (*boxes_)({coordinate[0][v], coordinate[1][v], coordinate[2][v]});
    for (std::size_t k = 0; k < static_cast<std::size_t>(group.count); ++k) {
        const auto& c = group.corner[k];
        reach[k] = (*side.boxes)(at[c[0]], at[c[1]], at[c[2]]);
    }
}

}  // namespace crumple
