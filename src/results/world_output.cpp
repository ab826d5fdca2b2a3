#include "results/world_output.h"

#include <algorithm>
#include <utility>

namespace crumple {

void clear(WorldCollisions& result, const WorldOutline& outline, const Intersect& question) {
    result.any = false;
    result.count = 0;
    result.statistics = {};
    result.statistics.triangles = outline.triangles();
    for (auto* list : {&result.world_counts, &result.world_offsets, &result.body_offsets, &result.first_triangle})
        list->clear();
    result.world_hit.clear();
    result.hit.clear();
    result.bodies.clear();
    result.pairs.clear();
    result.contacts.kinds.clear();
    result.contacts.offsets.clear();
    result.contacts.points.clear();
    const auto worlds = static_cast<std::size_t>(outline.worlds());
    if (question.wants >= Wants::any_by_world) result.world_hit.assign(worlds, 0);
    if (question.wants >= Wants::count) result.world_counts.assign(worlds, 0);
    if (question.wants == Wants::contacts) result.contacts.offsets.push_back(0);
}

WorldCollisions metered_world(MemoryMeter* m) {
    WorldCollisions result;
    for (auto* list : {&result.world_counts, &result.world_offsets, &result.body_offsets, &result.first_triangle})
        *list = Array<std::int64_t>(m);
    result.world_hit = Array<std::uint8_t>(m);
    result.hit = Array<std::uint8_t>(m);
    result.bodies = Array<BodyPair>(m);
    result.pairs = Array<Pair>(m);
    result.contacts = {Array<ContactKind>(m), Array<std::int64_t>(m), Array<std::array<double, 3>>(m)};
    return result;
}

void hand_over(WorldCollisions& result, WorldCollisions& other) {
    const auto swap = [](auto& mine, auto& theirs) {
        mine.swap_elements(theirs);
        mine.clear();
    };
    swap(result.world_hit, other.world_hit);
    swap(result.world_counts, other.world_counts);
    swap(result.bodies, other.bodies);
    swap(result.pairs, other.pairs);
    swap(result.contacts.kinds, other.contacts.kinds);
    swap(result.contacts.offsets, other.contacts.offsets);
    swap(result.contacts.points, other.contacts.points);
    swap(result.world_offsets, other.world_offsets);
    swap(result.body_offsets, other.body_offsets);
    swap(result.first_triangle, other.first_triangle);
    swap(result.hit, other.hit);
    other.any = std::exchange(result.any, false);
    other.count = std::exchange(result.count, 0);
    other.statistics = std::exchange(result.statistics, {});
}

void WorldBlocks::pass_on(WorldCollisions& result, bool last) const {
    const auto pairs = static_cast<std::int64_t>(result.pairs.size());
    if (pairs == 0 || (!last && pairs < how.block_pairs)) return;
    take(result);
    result.bodies.clear();
    result.pairs.clear();
    Contacts& contacts = result.contacts;
    contacts.kinds.clear();
    contacts.points.clear();
    contacts.offsets.resize(std::min<std::size_t>(contacts.offsets.size(), 1));
}

void hit(std::int32_t pass, const WorldOutline& outline, WorldCollisions& result) {
    result.any = true;
    if (pass < outline.worlds() && !result.world_hit.empty()) result.world_hit[pass] = 1;
}

void add_pair(const WorldOutline& outline, const Intersect& question, std::int32_t pass, BodyPair bodies, Pair pair,
              WorldCollisions& result) {
    hit(pass, outline, result);
    if (question.wants >= Wants::count) {
        ++result.count;
        if (pass < outline.worlds()) ++result.world_counts[pass];
    }
    if (question.wants >= Wants::pairs) {
        result.bodies.push_back(bodies);
        result.pairs.push_back(pair);
    } else if (question.wants == Wants::body_pairs) {
        if (result.bodies.empty() || result.bodies.back() != bodies) result.bodies.push_back(bodies);
    }
}

void add_contact(ContactKind kind, std::span<const std::array<double, 3>> points, WorldCollisions& result) {
    Contacts& contacts = result.contacts;
    contacts.kinds.push_back(kind);
    for (const auto& point : points) contacts.points.push_back(point);
    contacts.offsets.push_back(static_cast<std::int64_t>(contacts.points.size()));
}

void finish(const WorldOutline& outline, const Intersect& question, WorldCollisions& result) {
    if (question.wants == Wants::body_pairs) {
        std::sort(result.bodies.begin(), result.bodies.end());
        result.bodies.resize(
            static_cast<std::size_t>(std::unique(result.bodies.begin(), result.bodies.end()) - result.bodies.begin()));
    }
    if (!question.index || question.wants < Wants::pairs) return;
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
