#include "backends/cpu/intersections/memory_limit.h"

#include <algorithm>

#include "base/stopwatch.h"
#include "results/intersection_output.h"

namespace crumple::cpu {
namespace {

/// Calls visit(pair) for each pair that the call's query finds, in any order; duplicate triangles (copies.h) do not
/// occur.
template <class Visit>
void for_each_pair(IntersectCall call, Visit visit) {
    const auto take = [&](NarrowScratch& scratch, std::size_t) {
        for (const Pair& pair : scratch.pairs) visit(pair);
        scratch.pairs.clear();
    };
    const PairSink sink = take;
    call.low_memory = true;
    call.sink = &sink;
    measure(call);
    search_pairs(call);
}

}  // namespace

void find_in_chunks(IntersectCall call, Intersections& result) {
    PairBudget budget(call.scene, call.query, call.meter);
    const Copies& copies = call.leaves.copies();
    const auto n = static_cast<std::size_t>(call.scene.triangles[0]);
    result.offsets.assign(n + 1, 0);
    std::int64_t* offsets = result.offsets.data();
    for_each_pair(call, [&](Pair first) {
        budget.add(copies.count(first));
        copies.for_each(first, call.cancellation, [&](Pair pair) { ++offsets[pair.a + 1]; });
    });
    for (std::size_t i = 0; i < n; ++i) offsets[i + 1] += offsets[i];
    result.pairs.resize_discard(static_cast<std::size_t>(offsets[n]));
    const auto second = static_cast<std::int32_t>(call.scene.between ? n : 0);
    for_each_pair(call, [&](Pair first) {
        copies.for_each(first, call.cancellation, [&](Pair pair) {
            result.pairs[offsets[pair.a]++] = {pair.a, pair.b - second};
        });
    });
    Stopwatch watch;
    for (std::size_t i = n; i > 0; --i) offsets[i] = offsets[i - 1];
    offsets[0] = 0;
    for (std::size_t i = 0; i < n; ++i)
        std::sort(result.pairs.begin() + offsets[i], result.pairs.begin() + offsets[i + 1]);
    index_pairs(call.scene, result);
    write_contacts(call, result);
    call.statistics[Stage::output] += watch.lap();
}

}  // namespace crumple::cpu
