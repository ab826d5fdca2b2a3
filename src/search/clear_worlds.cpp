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
    decided_ = {};
    walks_.clear();
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
bool ClearWorlds::mark(Walk& walk, std::int32_t a, std::int32_t b, std::vector<Mark>& marks) const {
    const NearBody &at_a = bodies_[static_cast<std::size_t>(a)], &at_b = bodies_[static_cast<std::size_t>(b)];
    if (step_)
        walk.near.near_in_step(at_a, at_b, distance_, walk.groups);
    else if (walk.near.near(at_a, at_b, distance_, walk.groups))
        return true;
    for (const NearWalk::Groups& pair : walk.groups) {
        marks.push_back({a, pair.a});
        marks.push_back({b, pair.b});
    }
    return false;
}

bool ClearWorlds::selects_pairs_within(std::int32_t pass) const {
    const bool last = pass == outline_->worlds();
    const std::int32_t end = last ? outline_->bodies() : outline_->first_body(pass + 1);
    for (std::int32_t b = outline_->first_body(pass); b < end; ++b)
        if (rules_->within(b, outline_->body(b).self)) return true;
    return false;
}

void ClearWorlds::decide(Walk& walk, std::int32_t pass, Decided& decided) const {
    decided.verdict = Verdict::search;
    decided.marks.clear();
    if (selects_pairs_within(pass)) return;
    bool is_hit = false;
    near_.for_each_pair(pass, [&](std::int32_t a, std::int32_t b) {
        if (may_meet(a, b) && !tree(a).empty() && !tree(b).empty()) is_hit = mark(walk, a, b, decided.marks);
        return !is_hit && (subsets_ || decided.marks.empty());
    });
    std::vector<Mark>& marks = decided.marks;
    if (!is_hit && marks.empty()) decided.verdict = Verdict::clear;
    if (is_hit && subsets_) decided.verdict = Verdict::hit;
    if (is_hit || !subsets_) marks.clear();
    std::sort(marks.begin(), marks.end());
    marks.erase(std::unique(marks.begin(), marks.end()), marks.end());
}

void ClearWorlds::decide(ParallelFor& workers, bool any) {
    constexpr std::int32_t worlds_of_task = 16;  // each takes some microseconds
    any_hit_ = false;
    if (!is_read_) return;
    const std::int32_t count = outline_->worlds() + 1;
    decided_.resize(static_cast<std::size_t>(count));
    const auto make = [&] { return std::make_unique<Walk>(cancellation_, &meter_); };
    const auto run = [&](std::size_t task) {
        walks_.with(make, [&](Walk& walk) {
            const std::int32_t begin = static_cast<std::int32_t>(task) * worlds_of_task;
            for (std::int32_t pass = begin; pass < std::min(count, begin + worlds_of_task); ++pass) {
                cancellation_.check();
                Decided& decided = decided_[static_cast<std::size_t>(pass)];
                if (any && any_hit_) {
                    decided.verdict = Verdict::search;
                    decided.marks.clear();
                    continue;
                }
                decide(walk, pass, decided);
                if (decided.verdict == Verdict::hit) any_hit_ = true;
            }
        });
    };
    const auto tasks = static_cast<std::size_t>((count + worlds_of_task - 1) / worlds_of_task);
    if (tasks > 1)
        workers.parallel_for(tasks, run);
    else
        run(0);
}

}  // namespace crumple
