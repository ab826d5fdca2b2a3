#include "search/walks/near_walk.h"

#include "exact/distance/filtered_nearest.h"

namespace crumple {

void NearWalk::begin(const NearBody& a, const NearBody& b, double distance) {
    a_.begin(*a.tree, a.step);
    b_.begin(*b.tree, b.step);
    first_complete_a_ = a.first_complete;
    first_complete_b_ = b.first_complete;
    distance_ = distance;
    direction_ = {};
    marked_a_.groups.clear();
    marked_b_.groups.clear();
}

bool NearWalk::walk_from_roots() {
    const At root_a = at(a_, 0), root_b = at(b_, 0);
    if (gap(root_a.reach, root_b.reach) > limit_) return false;
    marked_a_.begin(a_.tree->groups());
    marked_b_.begin(b_.tree->groups());
    return walk(root_a, root_b);
}

bool NearWalk::near(const NearBody& a, const NearBody& b, double distance) {
    begin(a, b, distance);
    set_directions({}, distance);
    return walk_from_roots();
}

void NearWalk::near_in_step(const NearBody& a, const NearBody& b, double distance) {
    begin(a, b, distance);
    set_directions_of_step(distance);
    walk_from_roots();
}

// Visits two nodes that may be near each other. Returns true if two features are certainly near.
bool NearWalk::walk(const At& a, const At& b) {
    if (is_leaf(a_, a) && is_leaf(b_, b)) return visit(a_.tree->node(a.node).group, b_.tree->node(b.node).group);
    return visit_halves(a, b, [this](const At& p, const At& q) { return walk(p, q); });
}

bool NearWalk::visit(std::int32_t group_a, std::int32_t group_b) {
    poll();
    const auto is_marked = [](const Marked& marked, std::int32_t group) {
        return marked.has[static_cast<std::size_t>(group)] != 0;
    };
    if (is_step_ && is_marked(marked_a_, group_a) && is_marked(marked_b_, group_b)) return false;
    const PosedLeaf &a = posed(a_, group_a), &b = posed(b_, group_b);
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
    if (may_be_near && !is_near) {
        marked_a_.add(group_a);
        marked_b_.add(group_b);
    }
    return is_near;
}

}  // namespace crumple
