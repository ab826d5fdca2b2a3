#include "backends/duplicates.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "geometry/position_hash.h"
#include "geometry/predicates.h"

namespace crumple {
namespace {

using Positions = std::array<Vec3d, 3>;

Positions sorted(Positions p) {
    std::sort(p.begin(), p.end(),
              [](const Vec3d& a, const Vec3d& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
    return p;
}

/// For certain.
bool has_area(const Positions& p) {
    for (int axis = 0; axis < 3; ++axis)
        if (orient2d_filtered(p[0], p[1], p[2], axis) != undecided) return true;
    return false;
}

std::int64_t count(const Scene& scene, const Query& query, const GroupRule& rule, const Levels& levels,
                   MemoryMeter* meter) {
    const auto n = static_cast<std::int32_t>(scene.triangle_count());
    const std::uint64_t slots = std::bit_ceil(2 * static_cast<std::uint64_t>(n) + 1);
    Array<std::int32_t> table(meter), members(meter);  // the first of each class, and how many of it there are
    Array<std::uint8_t> taken(meter);                  // vertices
    table.assign(slots, -1);
    members.assign(static_cast<std::size_t>(n), 0);
    taken.assign(static_cast<std::size_t>(scene.vertex_count()), 0);
    const auto group = [&](std::int32_t t) { return rule.trivial() ? 0 : scene.group(t); };
    // Whether none of its corners belongs to a triangle that was asked about before.
    const auto shares_nothing = [&](std::int32_t t) {
        const std::int32_t* c = scene.corners + 3 * std::int64_t{t};
        if (taken[c[0]] || taken[c[1]] || taken[c[2]]) return false;
        taken[c[0]] = taken[c[1]] = taken[c[2]] = 1;
        return true;
    };
    const SeededHash seeded;
    const PositionHash position;

    std::int64_t pairs = 0;
    for (std::int32_t t = 0; t < n; ++t) {
        // Both of a pair whose lowest clusters are the scene's meet there, and in no lower one.
        if (!levels.own(t, t) || !rule(group(t), group(t))) continue;
        const Positions p = sorted(scene.triangle(t).point);
        // Two triangles of one class collide if they share no vertex, and, as geometric neighbours, if they have an
        // area: they share three vertices, or they meet outside the hull of fewer.
        if (!(query.neighbours == Neighbours::geometric && has_area(p)) && !shares_nothing(t)) continue;
        std::uint64_t h = SeededHash::add(seeded.seed(), static_cast<std::uint32_t>(group(t)));
        for (const Vec3d& corner : p) h = SeededHash::add(h, position(corner));
        std::uint64_t slot = h & (slots - 1);
        const auto alike = [&](std::int32_t u) { return group(t) == group(u) && sorted(scene.triangle(u).point) == p; };
        while (table[slot] >= 0 && !alike(table[slot])) slot = (slot + 1) & (slots - 1);
        // Between two meshes those of the second one only meet those of the first, which come before them.
        const bool meets = !scene.between || scene.second(t), is_met = !scene.between || !scene.second(t);
        if (table[slot] >= 0 && meets) pairs += members[table[slot]];
        if (!is_met) continue;
        if (table[slot] < 0) table[slot] = t;
        ++members[table[slot]];
    }
    return pairs;
}

}  // namespace

std::int64_t count_duplicates(const Scene& scene, const Query& query, const GroupRule& rule, const Levels& levels,
                              MemoryMeter* meter) {
    if (query.intersections != Intersections::all || query.wanted == Wanted::between) return 0;
    try {
        return count(scene, query, rule, levels, meter);
    } catch (const MemoryMeter::Exceeded&) {
        return 0;
    }
}

}  // namespace crumple
