// Flags of worlds side by side: the work of each ends at its first hit.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "backends/cuda/intersections/intersection_search.h"

namespace crumple::cuda {

// In two rounds, for a hit is known only after a sweep. The first one sweeps every sixteenth unit, some of each world;
// the second one all units of those worlds that it has left. Hits stay if a list was too short, for each is a proof of
// its own, and worlds that have one are not swept again.
void Search::flag_worlds_at_once(std::span<std::uint8_t> flags) {
    plan();
    for (bool complete = false; !complete;) {
        cancellation_.check();
        lay_out_lists();
        lists_of_ = nobody;
        Clearing clearing;
        enqueue_until_sorted(clearing, nullptr);
        const WorldHits found{input().worlds().found(), static_cast<std::uint32_t>(pass_.plan.leaves_a_world())};
        for (const unsigned long long step : {16ull, 1ull}) {
            Counters* const c = pass_.counters;
            fill(stream_, &c->next_unit, 0, sizeof *c - offsetof(Counters, next_unit));
            pass_.sweep({.step = step, .decided = found});
            pass_.narrow({Hits::Mode::by_world, pass_.hits(), nullptr, nullptr, nullptr, found});
        }
        if (pass_.plan.guided) beside_.join(stream_);
        const Counters counters = read_counters();
        input().throw_error(counters);
        complete = pass_.plan.accepts(counters, pass_.scene.triangle_count(), options_, false);
        if (!complete) continue;
        count(counters, pass_.plan);
        flag_beyond(static_cast<std::size_t>(counters.beyond), flags);
    }
    pass_.plan.cold = false;
    pass_.plan.guided = true;
    input().worlds().read(stream_, flags);
}

// What even expansions could not hold, of worlds in which nothing else was found.
void Search::flag_beyond(std::size_t n, std::span<std::uint8_t> flags) {
    if (n == 0) return;
    std::vector<Pair> hits(decide_beyond(n));
    copy(hits.data(), pass_.beyond(), hits.size(), cudaMemcpyDeviceToHost);
    const std::int64_t *first = pass_.scene.first_of_world, *end = first + pass_.scene.worlds;
    for (const Pair& hit : hits)
        flags[static_cast<std::size_t>(std::upper_bound(first, end, std::int64_t{hit.a}) - first) - 1] = 1;
}

}  // namespace crumple::cuda
