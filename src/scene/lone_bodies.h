#pragma once

// Rejects bodies that have edges and points but no triangles, because queries about triangles would silently ignore
// them.

#include <algorithm>
#include <string>

#include "crumple/error.h"
#include "crumple/world.h"
#include "scene/body_filter.h"

namespace crumple {

/// Throws Error (invalid_argument) for the first body that has edges or points but no triangles, if the filter selects
/// a pair with it; `within`: pairs within a body count, too. `what`: the reason, as a clause of the message. Skips
/// invalid bodies and shapes; the caller's validation reports them. Costs nothing if all shapes have triangles.
inline void check_bodies_have_triangles(const World& world, const PairFilter& given, bool within, const char* what) {
    const auto is_lone = [](const Shape& shape) {
        const bool lists = (shape.edges && !shape.edges->empty()) || (shape.points && !shape.points->empty());
        return shape.triangles.rows == 0 && lists;
    };
    if (std::none_of(world.shapes.begin(), world.shapes.end(), is_lone)) return;
    const auto shape_of = [&](const Body& body) -> const Shape* {
        const auto shape = static_cast<std::size_t>(body.shape);
        return shape < world.shapes.size() ? &world.shapes[shape] : nullptr;
    };
    BodyFilter rules(nullptr);
    rules.prepare(given);
    const auto meet = [&](std::size_t a, std::size_t b) {
        const Body &p = world.bodies[a], &q = world.bodies[b];
        if (p.world != q.world && p.world != -1 && q.world != -1) return false;
        const Shape *s = shape_of(p), *t = shape_of(q);
        const bool by_group = s && t && s->groups.empty() && t->groups.empty();
        const auto i = static_cast<std::int32_t>(a), j = static_cast<std::int32_t>(b);
        const bool wanted = a == b ? within && rules.within(i, p.self) : rules.between(i, j);
        return wanted && (!by_group || rules.groups(p.group, q.group));
    };
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        const Shape* const shape = shape_of(world.bodies[b]);
        if (!shape || !is_lone(*shape)) continue;
        for (std::size_t other = 0; other < world.bodies.size(); ++other)
            if (meet(b, other))
                throw Error(ErrorCode::invalid_argument,
                            "body " + std::to_string(b) + ": it has edges or points but no triangles, and " + what +
                                "; use a ProximityQuery for such bodies",
                            Element::body, static_cast<std::int64_t>(b));
    }
}

}  // namespace crumple
