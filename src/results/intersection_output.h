#pragma once

// What follows from the sorted pairs: offsets, hit flags, contacts.

#include <atomic>
#include <tuple>

#include "crumple/intersections.h"
#include "exact/intersection/contact.h"
#include "partition/levels.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// An empty result whose arrays the meter counts.
Intersections metered(MemoryMeter* meter);

/// Adds counts and times; says nothing of who did the work.
void add(const Statistics& some, Statistics& sum);

/// The same, and takes over who did it.
void add_pass(const Statistics& pass, Statistics& sum);

/// All arrays of a result.
inline auto arrays(Intersections& r) {
    return std::tie(r.world_hit, r.world_counts, r.bodies, r.inside, r.skipped, r.pairs, r.contacts.kinds,
                    r.contacts.offsets, r.contacts.points, r.offsets, r.hit_second, r.hit, r.world_offsets,
                    r.body_offsets, r.first_triangle);
}

/// Empties a result, keeps its memory.
void clear(Intersections& result);

/// Gives the memory of all arrays back.
void release(Intersections& result);

/// Gives `other` the result, and keeps the storage of `other`, emptied. Where a limit counts memory, `other` owns none.
void hand_over(Intersections& result, Intersections& other);

/// Offsets by first triangle and hit flags, from result.pairs (sorted).
void index_pairs(const PreparedScene& scene, Intersections& result);

/// Leaves only the pairs that a part owns of all those of its triangles; contacts are still to come.
void keep_owned(const PreparedScene& scene, const Levels& levels, Intersections& result);

/// Bytes of a result with so many pairs. Contacts take room for six points a pair until they are packed.
inline std::int64_t result_bytes(const PreparedScene& scene, const IntersectionQuery& query, std::int64_t pairs) {
    const std::int64_t contacts = pairs * (6 * 24 + 1 + 8) + 8;
    return pairs * 8 + (scene.triangles[0] + 1) * 8 + scene.triangle_count() + (query.contacts() ? contacts : 0);
}

/// The exact contacts of result.pairs. `for_each(n, task)` calls task(i) for i in [0, n), in any order or in parallel.
/// Returns how many took rational arithmetic.
template <class ForEach>
std::int64_t contacts_of_pairs(const PreparedScene& scene, Intersections& result, ForEach for_each) {
    const std::size_t n = result.pairs.size();
    const std::int64_t second = scene.between ? scene.triangles[0] : 0;
    Contacts& contacts = result.contacts;
    contacts.kinds.resize_discard(n);
    contacts.offsets.resize_discard(n + 1);
    contacts.points.resize_discard(6 * n);
    std::atomic<std::int64_t> rational{0};
    for_each(n, [&](std::size_t i) {
        const Pair pair = result.pairs[i];
        const Contact c = contact(scene.triangle(pair.a), scene.triangle(second + pair.b));
        if (c.rational) rational.fetch_add(1, std::memory_order_relaxed);
        contacts.kinds[i] = c.kind();
        contacts.offsets[i + 1] = c.count;
        for (std::size_t k = 0; k < static_cast<std::size_t>(c.count); ++k)
            contacts.points[6 * i + k] = {c.points[k].x, c.points[k].y, c.points[k].z};
    });
    // Counts become offsets, and points move together; they only ever move to the front.
    contacts.offsets[0] = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const std::int64_t begin = contacts.offsets[i], count = contacts.offsets[i + 1];
        for (std::int64_t k = 0; k < count; ++k)
            contacts.points[static_cast<std::size_t>(begin + k)] = contacts.points[6 * i + static_cast<std::size_t>(k)];
        contacts.offsets[i + 1] = begin + count;
    }
    contacts.points.resize(static_cast<std::size_t>(contacts.offsets[n]));
    return rational;
}

}  // namespace crumple
