#include "search/clear_worlds.h"

#include <algorithm>
#include <limits>

namespace crumple {
namespace {

std::int64_t length_of(const auto& list) { return list ? static_cast<std::int64_t>(list->size()) : 0; }

std::int64_t elements(const Shape& s) { return s.triangles.rows + length_of(s.edges) + length_of(s.points); }

bool can_read(const Shape& s) {
    return s.name != 0 && !s.end.data && s.radii.empty() && !s.rest.data && s.rest.rows == 0 &&
           elements(s) <= std::numeric_limits<std::int32_t>::max();
}

// Without lists, all vertices and edges of triangles are features. A list of points replaces the vertices of triangles
// and edges, a list of edges replaces the edges of triangles.
std::int32_t first_complete(const Shape& s) {
    if (s.points) return static_cast<std::int32_t>(s.triangles.rows + length_of(s.edges));
    return s.edges ? static_cast<std::int32_t>(s.triangles.rows) : 0;
}

// True if numbers of this type reach all coordinates of the box, so that no vertex in it can be posed to infinity.
bool is_within(const Bounds& box, ScalarType type) {
    const double most =
        type == ScalarType::float32 ? double{std::numeric_limits<float>::max()} : std::numeric_limits<double>::max();
    for (int axis = 0; axis < 3; ++axis)
        if (!(box.low[axis] >= -most && box.high[axis] <= most)) return false;
    return true;
}

}  // namespace

void ClearWorlds::release() {
    forget();
    bodies_ = std::vector<NearBody>();
    decided_ = std::vector<Decided>();
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
        if (is_within(box, outline.shape(b).vertices.type)) return box;
        finite = false;
        return no_bounds;
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
bool ClearWorlds::mark(Walk& walk, std::int32_t a, std::int32_t b) const {
    const NearBody &at_a = bodies_[static_cast<std::size_t>(a)], &at_b = bodies_[static_cast<std::size_t>(b)];
    if (step_)
        walk.near.near_in_step(at_a, at_b, distance_);
    else if (walk.near.near(at_a, at_b, distance_))
        return true;
    for (const std::int32_t group : walk.near.marked_a()) walk.marks.push_back({a, group});
    for (const std::int32_t group : walk.near.marked_b()) walk.marks.push_back({b, group});
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
    std::vector<Mark>& marks = walk.marks;
    marks.clear();
    bool is_hit = false;
    near_.for_each_pair(pass, [&](std::int32_t a, std::int32_t b) {
        if (may_meet(a, b) && !tree(a).empty() && !tree(b).empty()) is_hit = mark(walk, a, b);
        return !is_hit && (subsets_ || marks.empty());
    });
    if (!is_hit && marks.empty()) decided.verdict = Verdict::clear;
    if (is_hit && subsets_) decided.verdict = Verdict::hit;
    if (is_hit || !subsets_) return;
    std::sort(marks.begin(), marks.end());
    decided.marks.assign(marks.begin(), std::unique(marks.begin(), marks.end()));
}

void ClearWorlds::decide(ParallelFor& workers, std::int32_t begin, std::int32_t end, bool any) {
    constexpr std::int32_t worlds_of_task = 4;  // each takes some microseconds
    any_hit_ = false;
    if (!is_read_) return;
    first_ = begin;
    decided_.resize(static_cast<std::size_t>(end - begin));
    const auto make = [&] { return std::make_unique<Walk>(cancellation_, &meter_); };
    const auto run = [&](std::size_t task) {
        walks_.with(make, [&](Walk& walk) {
            const std::int32_t first = begin + static_cast<std::int32_t>(task) * worlds_of_task;
            for (std::int32_t pass = first; pass < std::min(end, first + worlds_of_task); ++pass) {
                cancellation_.check();
                Decided& decided = decided_[static_cast<std::size_t>(pass - begin)];
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
    const auto tasks = static_cast<std::size_t>((end - begin + worlds_of_task - 1) / worlds_of_task);
    if (tasks > 1)
        workers.parallel_for(tasks, run);
    else
        run(0);
}

}  // namespace crumple
