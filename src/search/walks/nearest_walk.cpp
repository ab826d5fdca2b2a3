#include "search/walks/nearest_walk.h"

#include <cmath>
#include <limits>
#include <utility>

#include "exact/intersection/contact.h"
#include "exact/intersection/decide_intersection.h"

namespace crumple {
namespace {

constexpr std::size_t few_candidates = 64;

Triangle first_triangle(const TrianglePoints& points) { return {points, {0, 1, 2}}; }
Triangle second_triangle(const TrianglePoints& points) { return {points, {3, 4, 5}}; }

bool apart(const TrianglePoints& a, const TrianglePoints& b) {
    const Bounds box_a{min(a[0], min(a[1], a[2])), max(a[0], max(a[1], a[2]))},
        box_b{min(b[0], min(b[1], b[2])), max(b[0], max(b[1], b[2]))};
    return !overlap(box_a, box_b);
}

}  // namespace

bool NearestWalk::operator()(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b,
                             double radius, NearestRow& row) {
    // First descends once in both trees to get an upper bound, then visits all nodes that are not farther apart than
    // this bound.
    if (!begin(a, tree_a, b, tree_b, radius)) return false;
    if (found_ && !touching_) set_directions(direction_, upper_);
    candidates_.clear();
    walk(at(a_, 0), at(b_, 0));
    if (!found_) return false;
    row.touching = touching_;
    row.triangles = closest_.triangles;
    if (touching_) {
        const Vec3d point = contact(first_triangle(closest_.a), second_triangle(closest_.b)).points[0];
        row.squared = 0;
        row.points = {point, point};
        return true;
    }
    const LeastDistance least = decide_nearest(candidates_, closest_, upper_, radius, counts_.rational);
    row.squared = least.squared;
    row.triangles = least.triangles;
    row.points = least.points;
    return least.within;
}

std::optional<double> NearestWalk::upper_bound(std::int32_t a, const ShapeTree& tree_a, std::int32_t b,
                                               const ShapeTree& tree_b, double radius) {
    if (!begin(a, tree_a, b, tree_b, radius)) return std::nullopt;
    return found_ ? upper_ : std::numeric_limits<double>::infinity();
}

/// Begins a walk, and descends once in both trees. Returns false if the bodies are certainly farther apart than
/// `radius`.
bool NearestWalk::begin(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b,
                        double radius) {
    if (tree_a.empty() || tree_b.empty()) return false;
    body_a_ = a;
    body_b_ = b;
    a_.begin(tree_a, {outline_.placement(a), {}});
    b_.begin(tree_b, {outline_.placement(b), {}});
    found_ = touching_ = false;
    direction_ = {};
    candidates_.clear();
    drop_threshold_ = few_candidates;
    upper_ = radius * (1 + 0x1p-50);
    set_directions({}, upper_);
    const At root_a = at(a_, 0), root_b = at(b_, 0);
    if (gap(root_a.reach, root_b.reach) > limit_) return false;
    descend(root_a, root_b);
    return true;
}

void NearestWalk::set_upper(double upper) {
    upper_ = upper;
    set_limit(upper);
}

void NearestWalk::descend(At a, At b) {
    while (!is_leaf(a_, a) || !is_leaf(b_, b)) {
        const bool split_a = first_is_split(a, b);
        At &whole = split_a ? a : b, &other = split_a ? b : a;
        const auto half = halves(split_a ? a_ : b_, whole.node);
        whole = half[gap(half[1].reach, other.reach) < gap(half[0].reach, other.reach)];
    }
    visit(a_.tree->node(a.node).group, b_.tree->node(b.node).group);
}

// Visits two nodes that may be as close as the closest pair so far.
void NearestWalk::walk(const At& a, const At& b) {
    if (touching_ && comes_later(a, b)) return;
    if (is_leaf(a_, a) && is_leaf(b_, b)) return visit(a_.tree->node(a.node).group, b_.tree->node(b.node).group);
    visit_halves(a, b, [this](const At& p, const At& q) {
        walk(p, q);
        return false;
    });
}

// True if all pairs of triangles below these nodes come after the touching pair in the order of the result.
bool NearestWalk::comes_later(const At& a, const At& b) const {
    const Pair first{a_.tree->first_element(a.node), b_.tree->first_element(b.node)};
    return first > closest_.triangles;
}

void NearestWalk::visit(std::int32_t group_a, std::int32_t group_b) {
    poll();
    const PosedLeaf &a = posed(a_, group_a), &b = posed(b_, group_b);
    for_each_close_pair(a, b, [&](std::size_t i, std::size_t j) { test(a, i, b, j); });
}

bool NearestWalk::wanted(const Pair& pair) const {
    if (rules_.allows_all_groups()) return true;
    const auto group_of = [&](std::int32_t body, std::int32_t triangle) {
        const auto& groups = outline_.shape(body).groups;
        return groups.empty() ? outline_.body(body).group : groups[static_cast<std::size_t>(triangle)];
    };
    return rules_.groups(group_of(body_a_, pair.a), group_of(body_b_, pair.b));
}

void NearestWalk::test(const PosedLeaf& a, std::size_t i, const PosedLeaf& b, std::size_t j) {
    const Pair pair{a.group->element[i], b.group->element[j]};
    if (!wanted(pair)) return;
    const TrianglePoints points_a = a.triangle(i), points_b = b.triangle(j);
    ++counts_.tests;
    if (touching_) return test_contact(pair, points_a, points_b);
    const TriangleGap gap(points_a, points_b);
    if (gap.lower(direction_) > upper_) return;
    const FilteredNearest quick(points_a, points_b, gap, upper_);
    if (quick.lower() > upper_) return;
    if (!(quick.lower() > 0)) {
        test_contact(pair, points_a, points_b);
        if (touching_) return;
    }
    candidates_.push_back({pair, points_a, points_b, quick.lower()});
    if (!found_ || quick.upper() < upper_) {
        found_ = true;
        closest_ = candidates_.back();
        direction_ = quick.direction();
        if (quick.upper() < upper_) set_upper(quick.upper());
    }
    if (candidates_.size() > drop_threshold_) drop_far_candidates();
}

void NearestWalk::test_contact(const Pair& pair, const TrianglePoints& a, const TrianglePoints& b) {
    if (touching_ && !(pair < closest_.triangles)) return;
    if (apart(a, b)) return;
    ++counts_.exact;
    DecisionCounts counts;
    const bool meet =
        collide(first_triangle(a), second_triangle(b), Neighbours::geometric, IntersectionKind::all, counts);
    counts_.rational += counts.rational;
    if (!meet) return;
    found_ = touching_ = true;
    closest_ = {pair, a, b, 0};
    set_upper(0);
}

void NearestWalk::drop_far_candidates() {
    std::size_t n = 0;
    for (const NearestCandidate& candidate : candidates_)
        if (!(candidate.lower > upper_)) candidates_[n++] = candidate;
    candidates_.resize(n);
    drop_threshold_ = 2 * n + few_candidates;
}

}  // namespace crumple
