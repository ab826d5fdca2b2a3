#include "search/walks/near_walk.h"

#include "exact/distance/filtered_nearest.h"

namespace crumple {

void NearWalk::begin(const NearBody& a, const NearBody& b, double distance, std::vector<Groups>& groups) {
    a_.begin(*a.tree, a.step);
    b_.begin(*b.tree, b.step);
    first_complete_a_ = a.first_complete;
    first_complete_b_ = b.first_complete;
    distance_ = distance;
    direction_ = {};
    groups_ = &groups;
    groups.clear();
}

bool NearWalk::near(const NearBody& a, const NearBody& b, double distance, std::vector<Groups>& groups) {
    begin(a, b, distance, groups);
    set_directions({}, distance);
    const At root_a = at(a_, 0), root_b = at(b_, 0);
    return !(gap(root_a.reach, root_b.reach) > limit_) && walk(root_a, root_b);
}

void NearWalk::near_in_step(const NearBody& a, const NearBody& b, double distance, std::vector<Groups>& groups) {
    begin(a, b, distance, groups);
    set_directions_of_step(distance);
    const At root_a = at(a_, 0), root_b = at(b_, 0);
    if (!(gap(root_a.reach, root_b.reach) > limit_)) walk(root_a, root_b);
}

// Visits two nodes that may be near each other. Of the two children, the closer one comes first. Returns true if two
// features are certainly near.
bool NearWalk::walk(const At& a, const At& b) {
    if (is_leaf(a_, a) && is_leaf(b_, b)) return visit({a_.tree->node(a.node).group, b_.tree->node(b.node).group});
    const bool split_a = first_is_split(a, b);
    const auto half = halves(split_a ? a_ : b_, (split_a ? a : b).node);
    const At& other = split_a ? b : a;
    const float gaps[2] = {gap(half[0].reach, other.reach), gap(half[1].reach, other.reach)};
    const std::size_t first = gaps[1] < gaps[0];
    for (const std::size_t k : {first, 1 - first})
        if (!(gaps[k] > limit_) && (split_a ? walk(half[k], other) : walk(other, half[k]))) return true;
    return false;
}

bool NearWalk::visit(const Groups& pair) {
    poll();
    const PosedLeaf &a = posed(a_, pair.a), &b = posed(b_, pair.b);
    bool is_near = false, may_be_near = false;
    for_each_close_pair(a, b, [&](std::size_t i, std::size_t j) {
        if (is_near) return;
        if (is_step_) {
            may_be_near = true;
            return;
        }
        const TrianglePoints points_a = a.triangle(i), points_b = b.triangle(j);
        const TriangleGap gap(points_a, points_b);
        if (gap.lower(direction_) > distance_) return;
        const FilteredNearest nearest(points_a, points_b, gap, distance_);
        if (nearest.lower() > distance_) {
            direction_ = nearest.direction();
            return;
        }
        const bool complete = a.group->element[i] >= first_complete_a_ && b.group->element[j] >= first_complete_b_;
        is_near = complete && nearest.upper() < distance_;
        may_be_near = true;
    });
    if (may_be_near && !is_near) groups_->push_back(pair);
    return is_near;
}

}  // namespace crumple
