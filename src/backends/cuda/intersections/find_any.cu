// Flags instead of pairs, for a scene or for each of its worlds side by side. The work on a scene or a world ends soon
// after its first hit.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "backends/cuda/intersections/intersection_finder.h"

namespace crumple::cuda {

bool IntersectionFinder::any() {
    statistics_ = {};
    bool found = false;
    if (fits_at_once([&] { found = any_at_once(); })) return found;
    refuse_worlds();
    in_chunks([&] { found = any_in_chunks(); });
    return found;
}

void IntersectionFinder::flag_worlds(std::span<std::uint8_t> flags) {
    statistics_ = {};
    if (!fits_at_once([&] { flag_worlds_at_once(flags); })) refuse_worlds();
}

// Works in two rounds of `sweep` and `narrow`, because hits are known only after both. If many pairs collide, a
// sixteenth of the sweep finds one, and the kernels of the second round end at once; if none does, the first round
// costs three launches. The second round appends to the first one's list of survivors, so the survivors of the first
// round are narrowed once more.
bool IntersectionFinder::any_at_once() {
    const auto rounds = [&] {
        unsigned long long* const found = &pass_.counters->hits;
        for (const Slice& slice : {Slice{0, 16, 1, found}, Slice{1, 16, 15, found}}) {
            pass_.sweep(slice);
            pass_.narrow({Hits::Mode::any, pass_.hits(), nullptr, nullptr});
        }
    };
    for (;;) {
        Counters counters{};
        const bool complete = pass_without_rows(rounds, counters);
        if (counters.hits > 0) return true;
        if (complete) return counters.beyond > 0 && decide_unresolved(static_cast<std::size_t>(counters.beyond)) > 0;
    }
}

// Works in two rounds of `sweep` and `narrow`, because hits are known only after both. The first one sweeps every
// sixteenth unit, some of each world; the second one all units of worlds without a hit. Hits remain valid if a list was
// too short, and worlds that have one are not swept again.
void IntersectionFinder::flag_worlds_at_once(std::span<std::uint8_t> flags) {
    const auto rounds = [&] {
        const WorldHits found{input().worlds().found(), static_cast<std::uint32_t>(pass_.plan.leaves_a_world())};
        for (const unsigned long long step : {16ull, 1ull}) {
            Counters* const c = pass_.counters;
            fill(stream_, &c->survivors, 0, sizeof *c - offsetof(Counters, survivors));
            pass_.sweep({.step = step, .decided = found});
            pass_.narrow({Hits::Mode::by_world, pass_.hits(), nullptr, nullptr, found});
        }
    };
    Counters counters{};
    while (!pass_without_rows(rounds, counters)) {
    }
    count(counters, pass_.plan);
    flag_unresolved(static_cast<std::size_t>(counters.beyond), flags);
    input().worlds().read(stream_, flags);
}

// Sets the flags of worlds with a pair that expansions could not decide and that the host finds to collide.
void IntersectionFinder::flag_unresolved(std::size_t n, std::span<std::uint8_t> flags) {
    if (n == 0) return;
    std::vector<Pair> hits(decide_unresolved(n));
    copy_now(stream_, hits.data(), pass_.beyond(), hits.size(), cudaMemcpyDeviceToHost);
    const std::int64_t *first = scene().first_of_world, *end = first + scene().worlds;
    for (const Pair& hit : hits)
        flags[static_cast<std::size_t>(std::upper_bound(first, end, std::int64_t{hit.a}) - first) - 1] = 1;
}

}  // namespace crumple::cuda
