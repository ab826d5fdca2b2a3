#include "search/first_hit.h"

#include <cstring>
#include <utility>

#include "exact/intersection/decide_intersection.h"
#include "geometry/two.h"

namespace crumple {
namespace {

// Returns triangle k of a posed group. Its vertex indices start at `first`, so that triangles of two bodies share none.
Triangle triangle_of(const PosedGroup& posed, int k, std::int32_t first) {
    const auto& c = posed.group->corner[static_cast<std::size_t>(k)];
    return {{posed.vertex(c[0]), posed.vertex(c[1]), posed.vertex(c[2])}, {first + c[0], first + c[1], first + c[2]}};
}

// Gives corners at equal positions the same vertex index: that of the first of them.
void weld(Triangle& a, Triangle& b) {
    std::array<std::pair<Vec3d*, std::int32_t*>, 6> corner;
    for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = {&a.point[k], &a.vertex[k]};
        corner[3 + k] = {&b.point[k], &b.vertex[k]};
    }
    for (std::size_t i = 1; i < corner.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (*corner[i].first == *corner[j].first) {
                *corner[i].second = *corner[j].second;
                break;
            }
}

}  // namespace

void PosedGroup::pose(const ShapeTree& tree, const Placement& place, std::int32_t g) {
    index = g;
    group = &tree.group(g);
    tree.pose(*group, place, coordinate);
    for (int axis = 0; axis < 3; ++axis) {
        Two low = load_two(coordinate[axis]), high = low;
        for (std::int32_t v = 2; v < 4 * group->blocks; v += 2) {
            const Two value = load_two(coordinate[axis] + v);
            low = value < low ? value : low;
            high = value > high ? value : high;
        }
        all.low[axis] = min(low[0], low[1]);
        all.high[axis] = max(high[0], high[1]);
    }
}

Bounds PosedGroup::box(int k) const {
    const auto& c = group->corner[static_cast<std::size_t>(k)];
    const Vec3d p = vertex(c[0]), q = vertex(c[1]), r = vertex(c[2]);
    return {min(p, min(q, r)), max(p, max(q, r))};
}

std::span<const PosedGroup::Boxed> PosedGroup::boxes_overlapping(const Bounds& other, Buffers& room) const {
    // For each vertex six bits, one for each side of `other`: 1 if the vertex lies beyond that side.
    std::int64_t beyond[3 * ShapeTree::most_elements];
    for (std::int32_t v = 0; v < 4 * group->blocks; v += 2) {
        TwoMasks sides{};
        for (int axis = 0; axis < 3; ++axis) {
            const Two value = load_two(coordinate[axis] + v);
            sides |= ((value < other.low[axis]) & (1 << axis)) | ((value > other.high[axis]) & (8 << axis));
        }
        std::memcpy(beyond + v, &sides, sizeof sides);
    }
    std::size_t n = 0;
    for (int k = 0; k < group->count; ++k) {
        const auto& c = group->corner[static_cast<std::size_t>(k)];
        if ((beyond[c[0]] & beyond[c[1]] & beyond[c[2]]) == 0) room[n++] = {box(k), k};
    }
    return {room.data(), n};
}

bool bodies_meet(const WorldOutline& outline, const IntersectionQuery& query, const BodyFilter& rules, std::int32_t a,
                 const ShapeTree& tree_a, std::int32_t b, const ShapeTree& tree_b, std::int64_t& decided) {
    const Placement place_a = outline.placement(a), place_b = outline.placement(b);
    const auto group_of = [&](std::int32_t body, std::int32_t triangle) {
        const auto& groups = outline.shape(body).groups;
        return groups.empty() ? outline.body(body).group : groups[static_cast<std::size_t>(triangle)];
    };
    PosedGroup of_a, of_b;
    return !for_each_overlap(tree_a, place_a, tree_b, place_b, [&](std::int32_t group_a, std::int32_t group_b) {
        if (of_a.index != group_a) of_a.pose(tree_a, place_a, group_a);
        if (of_b.index != group_b) of_b.pose(tree_b, place_b, group_b);
        if (!overlap(of_a.all, of_b.all)) return true;
        PosedGroup::Buffers buffer_a, buffer_b;
        // Starts with the larger group, because a smaller fraction of its triangles is near the other group.
        const bool a_first = largest(of_a.all.high - of_a.all.low) > largest(of_b.all.high - of_b.all.low);
        const auto near_one =
            a_first ? of_a.boxes_overlapping(of_b.all, buffer_a) : of_b.boxes_overlapping(of_a.all, buffer_b);
        if (near_one.empty()) return true;
        Bounds reach = no_bounds;
        for (const auto& [box, i] : near_one) reach.widen(box);
        const auto near_other =
            a_first ? of_b.boxes_overlapping(reach, buffer_b) : of_a.boxes_overlapping(reach, buffer_a);
        const auto &near_a = a_first ? near_one : near_other, &near_b = a_first ? near_other : near_one;
        for (const auto& [box_i, i] : near_a) {
            for (const auto& [box_j, j] : near_b) {
                if (!overlap(box_i, box_j)) continue;
                if (!rules.allows_all_groups() &&
                    !rules.groups(group_of(a, of_a.group->element[static_cast<std::size_t>(i)]),
                                  group_of(b, of_b.group->element[static_cast<std::size_t>(j)])))
                    continue;
                ++decided;
                Triangle s = triangle_of(of_a, i, 0), t = triangle_of(of_b, j, 3 * ShapeTree::most_elements);
                if (query.weld) weld(s, t);
                DecisionCounts counts;
                if (collide(s, t, query.neighbours, query.kind, counts)) return false;
            }
        }
        return true;
    });
}

}  // namespace crumple
