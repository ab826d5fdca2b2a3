#include "backends/cpu/stages/copies.h"

#include <bit>

namespace crumple::cpu {

void Copies::find(const PreparedScene& scene, const SceneFilter& rule, const Levels& levels,
                  const std::uint8_t* included) {
    next_.clear();
    const auto n = static_cast<std::int32_t>(scene.triangle_count());
    const auto repeats_corner = [&](std::int32_t t) {
        const std::int32_t* c = scene.corners + 3 * std::int64_t{t};
        return (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) && (!included || included[t]);
    };
    const auto group = [&](std::int32_t t) { return rule.trivial() ? 0 : scene.group(t); };
    const auto alike = [&](std::int32_t t, std::int32_t u) {
        const std::int32_t *c = scene.corners + 3 * std::int64_t{t}, *d = scene.corners + 3 * std::int64_t{u};
        return std::equal(c, c + 3, d) && group(t) == group(u) && scene.second(t) == scene.second(u) &&
               std::all_of(levels.begin(), levels.end(),
                           [&](const ClusterLevel& l) { return l.masks[t] == l.masks[u]; });
    };
    const auto hash = [&](std::int32_t t) {
        const std::int32_t* c = scene.corners + 3 * std::int64_t{t};
        const auto bits = [](std::int32_t value) { return std::uint64_t{static_cast<std::uint32_t>(value)}; };
        const std::uint64_t h = SeededHash::add(hash_.seed(), bits(c[0]) << 32 | bits(c[1]));
        return SeededHash::add(h, bits(c[2]) << 33 | std::uint64_t{scene.second(t)} << 32 | bits(group(t)));
    };

    std::uint64_t count = 0;
    for (std::int32_t t = 0; t < n; ++t) count += repeats_corner(t);
    const std::uint64_t slots = std::bit_ceil(2 * count + 1);
    table_.assign(slots, -1);
    for (std::int32_t t = 0; t < n; ++t) {
        if (!repeats_corner(t)) continue;
        std::uint64_t slot = hash(t) & (slots - 1);
        while (table_[slot] >= 0 && !alike(table_[slot], t)) slot = (slot + 1) & (slots - 1);
        if (table_[slot] >= 0) {
            if (next_.empty()) next_.assign(static_cast<std::size_t>(n), -1);
            next_[table_[slot]] = t;
        }
        table_[slot] = t;
    }
}

void Copies::leave_out(Array<std::uint8_t>& included) const {
    if (!empty() && included.empty()) included.assign(next_.size(), 1);
    for (const std::int32_t t : next_)
        if (t >= 0) included[t] = 0;
}

void Copies::expand(Array<Pair>& pairs, Cancellation& cancellation) const {
    if (empty()) return;
    const std::size_t found = pairs.size();
    std::size_t all = 0;
    for (const Pair& pair : pairs) all += static_cast<std::size_t>(count(pair));
    pairs.reserve(all);
    for (std::size_t i = 0; i < found; ++i) {
        const Pair first = pairs[i];
        for_each(first, cancellation, [&](Pair pair) {
            if (pair != first) pairs.push_back(pair);
        });
    }
}

}  // namespace crumple::cpu
