#include "results/world_output.h"

#include <algorithm>

#include "results/intersection_output.h"

namespace crumple {

void clear(Intersections& result, const WorldOutline& outline, const IntersectionQuery& query) {
    clear(result);
    result.statistics.triangles = outline.triangles();
    const auto worlds = static_cast<std::size_t>(outline.worlds());
    if (query.output >= Output::any_by_world) result.world_hit.assign(worlds, 0);
    if (query.output >= Output::count) result.world_counts.assign(worlds, 0);
    if (query.output == Output::contacts) result.contacts.offsets.push_back(0);
}

void WorldBlocks::deliver_if_full(Intersections& result, bool last) const {
    const auto pairs = static_cast<std::int64_t>(result.pairs.size());
    if (pairs == 0 || (!last && pairs < most)) return;
    take(result);
    result.bodies.clear();
    result.pairs.clear();
    Contacts& contacts = result.contacts;
    contacts.kinds.clear();
    contacts.points.clear();
    contacts.offsets.resize(std::min<std::size_t>(contacts.offsets.size(), 1));
}

void hit(std::int32_t pass, const WorldOutline& outline, Intersections& result) {
    result.any = true;
    if (pass < outline.worlds() && !result.world_hit.empty()) result.world_hit[pass] = 1;
}

void add_pair(const WorldOutline& outline, const IntersectionQuery& query, std::int32_t pass, BodyPair bodies,
              Pair pair, Intersections& result) {
    hit(pass, outline, result);
    if (query.output >= Output::count) {
        ++result.count;
        if (pass < outline.worlds()) ++result.world_counts[pass];
    }
    if (query.output >= Output::pairs) {
        result.bodies.push_back(bodies);
        result.pairs.push_back(pair);
    } else if (query.output == Output::body_pairs) {
        if (result.bodies.empty() || result.bodies.back() != bodies) result.bodies.push_back(bodies);
    }
}

void add_contact(ContactKind kind, std::span<const std::array<double, 3>> points, Intersections& result) {
    Contacts& contacts = result.contacts;
    contacts.kinds.push_back(kind);
    for (const auto& point : points) contacts.points.push_back(point);
    contacts.offsets.push_back(static_cast<std::int64_t>(contacts.points.size()));
}

void add_contained(std::span<const BodyPair> pairs, Intersections& result) {
    for (const BodyPair& pair : pairs) result.bodies.push_back(pair);
    std::sort(result.bodies.begin(), result.bodies.end());
    result.inside.resize_discard(result.bodies.size());
    std::transform(result.bodies.begin(), result.bodies.end(), result.inside.begin(),
                   [&](const BodyPair& pair) { return std::binary_search(pairs.begin(), pairs.end(), pair); });
}

void finish(const WorldOutline& outline, const IntersectionQuery& query, Intersections& result) {
    if (query.output == Output::body_pairs) {
        std::sort(result.bodies.begin(), result.bodies.end());
        result.bodies.resize(
            static_cast<std::size_t>(std::unique(result.bodies.begin(), result.bodies.end()) - result.bodies.begin()));
    }
    if (!query.index || query.output < Output::pairs) return;
    const auto bodies = static_cast<std::size_t>(outline.bodies()), worlds = static_cast<std::size_t>(outline.worlds());
    result.first_triangle.resize_discard(bodies + 1);
    for (std::size_t b = 0; b <= bodies; ++b)
        result.first_triangle[b] = outline.first_triangle(static_cast<std::int32_t>(b));
    result.hit.assign(static_cast<std::size_t>(outline.triangles()), 0);
    result.body_offsets.assign(bodies + 1, 0);
    for (std::size_t i = 0; i < result.pairs.size(); ++i) {
        const BodyPair& pair = result.bodies[i];
        ++result.body_offsets[pair.first + 1];
        result.hit[outline.first_triangle(pair.first) + result.pairs[i].a] = 1;
        result.hit[outline.first_triangle(pair.second) + result.pairs[i].b] = 1;
    }
    for (std::size_t b = 0; b < bodies; ++b) result.body_offsets[b + 1] += result.body_offsets[b];
    result.world_offsets.resize_discard(worlds + 1);
    result.world_offsets[0] = 0;
    for (std::size_t w = 0; w < worlds; ++w)
        result.world_offsets[w + 1] = result.world_offsets[w] + result.world_counts[w];
}

}  // namespace crumple
