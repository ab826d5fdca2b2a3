#pragma once

// What follows from the sorted pairs: offsets, hit flags, contacts.

#include <atomic>

#include "crumple/collisions.h"
#include "exact/intersection/contact.h"
#include "partition/levels.h"
#include "scene/scene.h"

namespace crumple {

/// An empty result whose arrays the meter counts.
Collisions metered(MemoryMeter* meter);

/// Adds counts and times; says nothing of who did the work.
void add(const Statistics& some, Statistics& sum);

/// The same, and takes over who did it.
void add_pass(const Statistics& pass, Statistics& sum);

/// Gives the memory of all arrays back.
inline void release(Collisions& result) {
    result.pairs.release();
    result.offsets.release();
    result.hit.release();
    result.hit_second.release();
    result.contacts.kinds.release();
    result.contacts.offsets.release();
    result.contacts.points.release();
}

/// Offsets by first triangle and hit flags, from result.pairs (sorted).
void index_pairs(const Scene& scene, Collisions& result);

/// Leaves only the pairs that a part owns of all those of its triangles; contacts are still to come.
void keep_owned(const Scene& scene, const Levels& levels, Collisions& result);

/// Bytes of a result with so many pairs. Contacts take room for six points a pair until they are packed.
inline std::int64_t result_bytes(const Scene& scene, const Query& query, std::int64_t pairs) {
    const std::int64_t contacts = pairs * (6 * 24 + 1 + 8) + 8;
    return pairs * 8 + (scene.triangles[0] + 1) * 8 + scene.triangle_count() + (query.contacts ? contacts : 0);
}

/// The exact contacts of result.pairs. `for_each(n, task)` calls task(i) for i in [0, n), in any order or in parallel.
/// Returns how many took rational arithmetic.
template <class ForEach>
std::int64_t contacts_of_pairs(const Scene& scene, Collisions& result, ForEach for_each) {
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
