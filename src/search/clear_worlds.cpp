#include "search/clear_worlds.h"

#include <algorithm>

namespace crumple {

void ClearWorlds::release() {
    forget();
    bodies_ = {};
    marks_ = {};
    near_ = NearBodies(&meter_);
}

void ClearWorlds::read(const WorldOutline& outline, const BodyFilter& rules, bool step, double reach) {
    forget();
    const auto& shapes = outline.world().shapes;
    const auto knows = [](const Shape& s) {
        return s.name != 0 && !s.edges && !s.points && !s.end.data && s.radii.empty() && !s.rest.data &&
               s.rest.rows == 0;
    };
    if (shapes.empty() || !std::all_of(shapes.begin(), shapes.end(), knows)) return;
    outline_ = &outline;
    rules_ = &rules;
    trees_.begin();
    std::vector<const ShapeTree*> tree(shapes.size());
    for (std::size_t s = 0; s < shapes.size(); ++s) tree[s] = &trees_.named(shapes[s], s);
    // The boxes have more slack than the rounding of their bounds needs, so this only has to cover the rounding of
    // `reach`.
    half_ = reach / 2 * (1 + 0x1p-40);
    bodies_.clear();
    for (std::int32_t b = 0; b < outline.bodies(); ++b)
        bodies_.push_back({tree[static_cast<std::size_t>(outline.body(b).shape)], outline.placement(b),
                           step ? outline.end_placement(b) : outline.placement(b)});
    bool finite = true;
    near_.prepare(outline, [&](std::int32_t b) {
        const Posed& body = bodies_[static_cast<std::size_t>(b)];
        if (body.tree->empty()) return no_bounds;
        const Bounds box = bounds(body, body.tree->box());
        finite = finite && all_finite(box.low) && all_finite(box.high);
        return box;
    });
    known_ = finite;
}

// Vertices move straight from start to end, so a box that contains both positions contains their trajectories.
Bounds ClearWorlds::bounds(const Posed& body, const CentredBox& box) const {
    Bounds all = body.start(box);
    all.widen(body.end(box));
    const Vec3d half{half_, half_, half_};
    return {all.low - half, all.high + half};
}

bool ClearWorlds::may_meet(std::int32_t a, std::int32_t b) const {
    if (!rules_->between(a, b)) return false;
    const bool grouped = !outline_->shape(a).groups.empty() || !outline_->shape(b).groups.empty();
    return grouped || rules_->groups(outline_->body(a).group, outline_->body(b).group);
}

// Walks both trees at once: of two nodes, splits the larger one.
void ClearWorlds::mark(std::int32_t a, std::int32_t node_a, std::int32_t b, std::int32_t node_b) {
    const Posed &at_a = bodies_[static_cast<std::size_t>(a)], &at_b = bodies_[static_cast<std::size_t>(b)];
    const ShapeTree::Node &first = at_a.tree->node(node_a), &second = at_b.tree->node(node_b);
    if (!overlap(bounds(at_a, at_a.tree->box(first)), bounds(at_b, at_b.tree->box(second)))) return;
    const bool leaf_a = first.group >= 0, leaf_b = second.group >= 0;
    const double extent_a = first.extent() * at_a.tree->frame().unit,
                 extent_b = second.extent() * at_b.tree->frame().unit;
    if (leaf_a && leaf_b) {
        marks_.push_back({a, first.group});
        marks_.push_back({b, second.group});
    } else if (leaf_b || (!leaf_a && extent_a > extent_b)) {
        mark(a, node_a + 1, b, node_b);
        mark(a, first.right, b, node_b);
    } else {
        mark(a, node_a, b, node_b + 1);
        mark(a, node_a, b, second.right);
    }
}

bool ClearWorlds::clear(std::int32_t pass) {
    marks_.clear();
    if (!known_) return false;
    const bool last = pass == outline_->worlds();
    const std::int32_t end = last ? outline_->bodies() : outline_->first_body(pass + 1);
    for (std::int32_t b = outline_->first_body(pass); b < end; ++b)
        if (rules_->within(b, outline_->body(b).self)) return false;
    near_.for_each_pair(pass, [&](std::int32_t a, std::int32_t b) {
        if (may_meet(a, b) && !tree(a).empty() && !tree(b).empty()) mark(a, 0, b, 0);
        return true;
    });
    std::sort(marks_.begin(), marks_.end());
    marks_.erase(std::unique(marks_.begin(), marks_.end()), marks_.end());
    return marks_.empty();
}

}  // namespace crumple
