#include "search/clear_worlds.h"

#include <algorithm>
#include <limits>

namespace crumple {
namespace {

std::int64_t size_of(const auto& list) { return list ? static_cast<std::int64_t>(list->size()) : 0; }

std::int64_t elements(const Shape& s) { return s.triangles.rows + size_of(s.edges) + size_of(s.points); }

bool can_read(const Shape& s) {
    return s.name != 0 && !s.end.data && s.radii.empty() && !s.rest.data && s.rest.rows == 0 &&
           elements(s) <= std::numeric_limits<std::int32_t>::max();
}

// Without lists, all vertices and edges of triangles are features. A list of points replaces the vertices of triangles
// and edges, a list of edges replaces the edges of triangles.
std::int32_t first_complete(const Shape& s) {
    if (s.points) return static_cast<std::int32_t>(s.triangles.rows + size_of(s.edges));
    return s.edges ? static_cast<std::int32_t>(s.triangles.rows) : 0;
}

}  // namespace

void ClearWorlds::release() {
    forget();
    bodies_ = {};
    marks_ = {};
    groups_ = {};
    walk_.release();
    near_ = NearBodies(&meter_);
}

void ClearWorlds::read(const WorldOutline& outline, const BodyFilter& rules, bool step, double distance, bool subsets) {
    forget();
    const auto& shapes = outline.world().shapes;
    if (shapes.empty() || !std::all_of(shapes.begin(), shapes.end(), can_read)) return;
    outline_ = &outline;
    rules_ = &rules;
    step_ = step;
    distance_ = distance;
    subsets_ = subsets;
    trees_.begin();
    std::vector<const ShapeTree*> tree(shapes.size());
    for (std::size_t s = 0; s < shapes.size(); ++s) tree[s] = &trees_.named(shapes[s], s, TreeElements::all);
    bodies_.clear();
    for (std::int32_t b = 0; b < outline.bodies(); ++b)
        bodies_.push_back({tree[static_cast<std::size_t>(outline.body(b).shape)],
                           {outline.placement(b), step ? outline.end_placement(b) : outline.placement(b)},
                           first_complete(outline.shape(b))});
    bool finite = true;
    near_.prepare(outline, [&](std::int32_t b) {
        const NearBody& body = bodies_[static_cast<std::size_t>(b)];
        if (body.tree->empty()) return no_bounds;
        const Bounds box = bounds(body);
        finite = finite && all_finite(box.low) && all_finite(box.high);
        return box;
    });
    is_read_ = finite;
}

// Returns a box of the whole body, inflated by half of the distance. Vertices move straight from start to end, so a box
// that contains both positions contains their trajectories. The box has more slack than the rounding of its bounds
// needs, so half of the distance only has to cover its own rounding.
Bounds ClearWorlds::bounds(const NearBody& body) const {
    Bounds all = body.step.start(body.tree->box());
    if (step_) all.widen(body.step.end(body.tree->box()));
    const double half = distance_ / 2 * (1 + 0x1p-40);
    const Vec3d margin{half, half, half};
    return {all.low - margin, all.high + margin};
}

bool ClearWorlds::may_meet(std::int32_t a, std::int32_t b) const {
    if (!rules_->between(a, b)) return false;
    const bool grouped = !outline_->shape(a).groups.empty() || !outline_->shape(b).groups.empty();
    return grouped || rules_->groups(outline_->body(a).group, outline_->body(b).group);
}

// Marks groups of the two bodies that may be near each other. Returns true if features of the bodies are certainly
// near.
bool ClearWorlds::walk(std::int32_t a, std::int32_t b) {
    const NearBody &at_a = bodies_[static_cast<std::size_t>(a)], &at_b = bodies_[static_cast<std::size_t>(b)];
    if (step_)
        walk_.near_in_step(at_a, at_b, distance_, groups_);
    else if (walk_.near(at_a, at_b, distance_, groups_))
        return true;
    for (const NearWalk::Groups& pair : groups_) {
        marks_.push_back({a, pair.a});
        marks_.push_back({b, pair.b});
    }
    return false;
}

ClearWorlds::Verdict ClearWorlds::decide(std::int32_t pass) {
    marks_.clear();
    if (!is_read_) return Verdict::search;
    const bool last = pass == outline_->worlds();
    const std::int32_t end = last ? outline_->bodies() : outline_->first_body(pass + 1);
    for (std::int32_t b = outline_->first_body(pass); b < end; ++b)
        if (rules_->within(b, outline_->body(b).self)) return Verdict::search;
    bool is_hit = false;
    near_.for_each_pair(pass, [&](std::int32_t a, std::int32_t b) {
        if (may_meet(a, b) && !tree(a).empty() && !tree(b).empty()) is_hit = walk(a, b);
        return !is_hit && (subsets_ || marks_.empty());
    });
    if (!subsets_) {
        const bool is_clear = marks_.empty() && !is_hit;
        marks_.clear();
        return is_clear ? Verdict::clear : Verdict::search;
    }
    if (is_hit) return Verdict::hit;
    std::sort(marks_.begin(), marks_.end());
    marks_.erase(std::unique(marks_.begin(), marks_.end()), marks_.end());
    return marks_.empty() ? Verdict::clear : Verdict::search;
}

}  // namespace crumple
