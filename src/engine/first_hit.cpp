#include "engine/first_hit.h"

#include "base/float_environment.h"
#include "questions/intersect/decide.h"

namespace crumple {
namespace {

// Vertices count by themselves in each body, from `first` on.
Triangle triangle_of(const PosedGroup& posed, int k, std::int32_t first) {
    const auto& c = posed.group->corner[static_cast<std::size_t>(k)];
    return {{posed.vertex[c[0]], posed.vertex[c[1]], posed.vertex[c[2]]}, {first + c[0], first + c[1], first + c[2]}};
}

// Equal positions become one vertex: the lowest.
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
    const Vec3d* given = tree.vertices(*group);
    for (std::int32_t v = 0; v < group->vertices; ++v) vertex[static_cast<std::size_t>(v)] = place(given[v]);
    all = no_bounds;
    for (std::size_t k = 0; k < static_cast<std::size_t>(group->count); ++k) {
        const auto& c = group->corner[k];
        const Vec3d &p = vertex[c[0]], &q = vertex[c[1]], &r = vertex[c[2]];
        box[k] = {min(p, min(q, r)), max(p, max(q, r))};
        all.widen(box[k]);
    }
}

bool bodies_meet(const WorldOutline& outline, const Intersect& question, const BodyRules& rules, std::int32_t a,
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
        for (int i = 0; i < of_a.group->count; ++i) {
            const Bounds& box = of_a.box[static_cast<std::size_t>(i)];
            if (!overlap(box, of_b.all)) continue;
            for (int j = 0; j < of_b.group->count; ++j) {
                if (!overlap(box, of_b.box[static_cast<std::size_t>(j)])) continue;
                if (!rules.any_group() && !rules.groups(group_of(a, of_a.group->triangle[static_cast<std::size_t>(i)]),
                                                        group_of(b, of_b.group->triangle[static_cast<std::size_t>(j)])))
                    continue;
                ++decided;
                Triangle s = triangle_of(of_a, i, 0), t = triangle_of(of_b, j, 3 * ShapeTree::most_triangles);
                if (question.weld) weld(s, t);
                DecisionCounts counts;
                if (collide(s, t, question.neighbours, question.intersections, counts)) return false;
            }
        }
        return true;
    });
}

}  // namespace crumple
