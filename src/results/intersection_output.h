#pragma once

// Makes the rest of a result from its sorted pairs: offsets, hit flags, contacts.

#include <atomic>
#include <tuple>

#include "crumple/intersections.h"
#include "exact/intersection/contact.h"
#include "partition/levels.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Returns an empty result whose arrays are counted by the meter.
Intersections metered(MemoryMeter* meter);

/// Adds counts and stage times, but not the number of threads, the backend or the instruction set.
void add(const Statistics& some, Statistics& sum);

/// Adds counts and stage times, and copies the number of threads, the backend and the instruction set.
void add_pass(const Statistics& pass, Statistics& sum);

/// Returns references to all arrays of a result.
inline auto arrays(Intersections& r) {
    return std::tie(r.world_hit, r.world_counts, r.bodies, r.inside, r.skipped, r.pairs, r.contacts.kinds,
                    r.contacts.offsets, r.contacts.points, r.offsets, r.hit_second, r.hit, r.world_offsets,
                    r.body_offsets, r.first_triangle);
}

/// Empties a result, but keeps its memory.
void clear(Intersections& result);

/// Frees the memory of all arrays.
void release(Intersections& result);

/// Moves `result` to `other`. `result` keeps the memory of `other`, emptied. Under a memory limit, `other` must own no
/// memory.
void swap_out(Intersections& result, Intersections& other);

/// Makes offsets by first triangle and hit flags from result.pairs, which are sorted.
void index_pairs(const PreparedScene& scene, Intersections& result);

/// Reduces result.pairs, which has all pairs of a part's triangles, to the pairs that the part owns, and makes offsets
/// and hit flags. `levels`: made from the part (partition/levels.h). Call before contacts are made.
void keep_owned(const PreparedScene& scene, const Levels& levels, Intersections& result);

/// Returns how many bytes the arrays of a result for one mesh or two take if it has this number of pairs. Contacts have
/// capacity for six points per pair until they are packed.
inline std::int64_t result_bytes(const PreparedScene& scene, const IntersectionQuery& query, std::int64_t pairs) {
    const std::int64_t contacts = pairs * (6 * 24 + 1 + 8) + 8;
    return pairs * 8 + (scene.triangles[0] + 1) * 8 + scene.triangle_count() + (query.contacts() ? contacts : 0);
}

/// Makes the exact contacts of result.pairs. `for_each(n, task)` calls task(i) for i in [0, n), in any order or in
/// parallel. Returns the number of contacts that needed rational arithmetic.
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
    // Converts counts to offsets and packs the points in place, since points only move to the front.
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
