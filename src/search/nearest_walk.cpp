#include "search/nearest_walk.h"

#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "exact/intersection/contact.h"
#include "exact/intersection/decide_intersection.h"

namespace crumple {
namespace {

constexpr std::size_t few_candidates = 64;
constexpr std::int64_t visits_between_checks = 4096;

Triangle first_triangle(const TrianglePoints& points) { return {points, {0, 1, 2}}; }
Triangle second_triangle(const TrianglePoints& points) { return {points, {3, 4, 5}}; }

bool apart(const TrianglePoints& a, const TrianglePoints& b) {
    const Bounds box_a{min(a[0], min(a[1], a[2])), max(a[0], max(a[1], a[2]))},
        box_b{min(b[0], min(b[1], b[2])), max(b[0], max(b[1], b[2]))};
    return !overlap(box_a, box_b);
}

}  // namespace

TrianglePoints PosedLeaf::triangle(std::size_t k) const {
    const auto& c = group->corner[k];
    const auto vertex = [&](std::size_t v) { return Vec3d{coordinate[0][v], coordinate[1][v], coordinate[2][v]}; };
    return {vertex(c[0]), vertex(c[1]), vertex(c[2])};
}

bool NearestWalk::operator()(std::int32_t a, const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b,
                             double radius, NearestRow& row) {
    // First descends once in both trees to get an upper bound, then visits all nodes that are not farther apart than
    // this bound.
    if (!begin(a, tree_a, b, tree_b, radius)) return false;
    if (found_ && !touching_) set_directions(direction_);
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
    begin(a_, a, tree_a);
    begin(b_, b, tree_b);
    found_ = touching_ = false;
    direction_ = {};
    candidates_.clear();
    drop_threshold_ = few_candidates;
    upper_ = radius * (1 + 0x1p-50);
    set_directions({});
    const At root_a = at(a_, 0), root_b = at(b_, 0);
    if (gap(root_a.reach, root_b.reach) > limit_) return false;
    descend(root_a, root_b);
    return true;
}

void NearestWalk::begin(Side& side, std::int32_t body, const ShapeTree& tree) {
    side.body = body;
    side.tree = &tree;
    side.place = outline_.placement(body);
    side.unit = static_cast<float>(tree.frame().unit);
}

// Sets the directions along which intervals are compared; `known` is one of them (box_distance.h). Empties the caches,
// because new directions invalidate all cached intervals.
void NearestWalk::set_directions(const Vec3d& known) {
    boxes_.emplace(a_.place, a_.tree->frame(), b_.place, b_.tree->frame(), known);
    a_.boxes = &boxes_->a();
    b_.boxes = &boxes_->b();
    a_.forget();
    b_.forget();
    limit_ = boxes_->limit(upper_);
}

void NearestWalk::set_upper(double upper) {
    upper_ = upper;
    limit_ = boxes_->limit(upper);
}

bool NearestWalk::first_is_split(const At& a, const At& b) const {
    const ShapeTree::Node &node_a = a_.tree->node(a.node), &node_b = b_.tree->node(b.node);
    if (node_a.group >= 0 || node_b.group >= 0) return node_b.group >= 0;
    return a_.unit * node_a.extent() > b_.unit * node_b.extent();
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

NearestWalk::Side::Side(MemoryMeter* meter) : leaves(meter) { leaves.resize(cached_leaves); }

void NearestWalk::Side::forget() { group.fill(-1); }

// Visits two nodes that may be as close as the closest pair so far. Of the two children, the closer one comes first.
void NearestWalk::walk(const At& a, const At& b) {
    if (touching_ && comes_later(a, b)) return;
    if (is_leaf(a_, a) && is_leaf(b_, b)) return visit(a_.tree->node(a.node).group, b_.tree->node(b.node).group);
    const bool split_a = first_is_split(a, b);
    const auto half = halves(split_a ? a_ : b_, (split_a ? a : b).node);
    const At& other = split_a ? b : a;
    const float gaps[2] = {gap(half[0].reach, other.reach), gap(half[1].reach, other.reach)};
    const std::size_t first = gaps[1] < gaps[0];
    for (const std::size_t k : {first, 1 - first}) {
        if (gaps[k] > limit_) continue;
        if (split_a)
            walk(half[k], other);
        else
            walk(other, half[k]);
    }
}

// True if all pairs of triangles below these nodes come after the touching pair in the order of the result.
bool NearestWalk::comes_later(const At& a, const At& b) const {
    const Pair first{a_.tree->first_triangle(a.node), b_.tree->first_triangle(b.node)};
    return first > closest_.triangles;
}

const PosedLeaf& NearestWalk::posed(Side& side, std::int32_t group) {
    const std::size_t place = static_cast<std::size_t>(group) % cached_leaves;
    PosedLeaf& leaf = side.leaves[place];
    if (side.group[place] == group) return leaf;
    side.group[place] = group;
    leaf.group = &side.tree->group(group);
    side.tree->pose(*leaf.group, side.place, leaf.coordinate);
    BoxDistance::Lanes at[3 * ShapeTree::most_triangles];
    const auto& coordinate = leaf.coordinate;
    for (std::int32_t v = 0; v < leaf.group->vertices; ++v)
        at[v] = (*boxes_)({coordinate[0][v], coordinate[1][v], coordinate[2][v]});
    for (std::size_t k = 0; k < static_cast<std::size_t>(leaf.group->count); ++k) {
        const auto& c = leaf.group->corner[k];
        const BoxDistance::Intervals reach = (*side.boxes)(at[c[0]], at[c[1]], at[c[2]]);
        leaf.reach[k] = reach;
        if (k == 0)
            leaf.all = reach;
        else
            leaf.all.widen(reach);
    }
    return leaf;
}

void NearestWalk::visit(std::int32_t group_a, std::int32_t group_b) {
    if (++visits_ % visits_between_checks == 0) cancellation_.check();
    const PosedLeaf &a = posed(a_, group_a), &b = posed(b_, group_b);
    if (gap(a.all, b.all) > limit_) return;
    std::array<std::size_t, ShapeTree::most_triangles> near_b;
    std::size_t n = 0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(b.group->count); ++j)
        if (!(gap(a.all, b.reach[j]) > limit_)) near_b[n++] = j;
    if (n == 0) return;
    BoxDistance::Intervals all_b = b.reach[near_b[0]];
    for (const std::size_t j : std::span(near_b.data(), n)) all_b.widen(b.reach[j]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(a.group->count); ++i) {
        if (gap(a.reach[i], all_b) > limit_) continue;
        for (const std::size_t j : std::span(near_b.data(), n))
            if (!(gap(a.reach[i], b.reach[j]) > limit_)) test(a, i, b, j);
    }
}

bool NearestWalk::wanted(const Pair& pair) const {
    if (rules_.allows_all_groups()) return true;
    const auto group_of = [&](std::int32_t body, std::int32_t triangle) {
        const auto& groups = outline_.shape(body).groups;
        return groups.empty() ? outline_.body(body).group : groups[static_cast<std::size_t>(triangle)];
    };
    return rules_.groups(group_of(a_.body, pair.a), group_of(b_.body, pair.b));
}

void NearestWalk::test(const PosedLeaf& a, std::size_t i, const PosedLeaf& b, std::size_t j) {
    const Pair pair{a.group->triangle[i], b.group->triangle[j]};
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
