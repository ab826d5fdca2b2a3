#include "backends/cpu/intersections/find_intersections.h"

#include <algorithm>

#include "base/stopwatch.h"
#include "results/intersection_output.h"

namespace crumple::cpu {

void search_pairs(const IntersectCall& call) {
    call.leaves.ask({&call.query, call.decides, call.sink, call.enough, call.stream});
    search(call);
}

void write_result(const IntersectCall& call, Intersections& result) {
    const auto found = call.leaves.found();
    const Copies& copies = call.leaves.copies();
    Stopwatch watch;
    if (!copies.empty())
        call.workers.parallel_for(
            found.size(), [&](std::size_t w, std::size_t) { copies.expand(call.leaves.found(w), call.cancellation); });
    write_output(call.scene, call.workers, found, call.output, result);
    call.leaves.pairs_before = result.pairs.size();
    write_contacts(call, result);
    call.statistics[Stage::output] += watch.lap();
}

void write_contacts(const IntersectCall& call, Intersections& result) {
    result.contacts.kinds.clear();
    result.contacts.offsets.clear();
    result.contacts.points.clear();
    if (!call.query.contacts()) return;
    constexpr std::size_t batch = 256;
    call.statistics.rational_contacts += contacts_of_pairs(call.scene, result, [&](std::size_t n, auto task) {
        call.workers.parallel_for((n + batch - 1) / batch, [&](std::size_t b, std::size_t) {
            for (std::size_t i = b * batch; i < std::min(n, (b + 1) * batch); ++i) task(i);
        });
    });
}

void find(const IntersectCall& call, Intersections& result) {
    measure(call);
    search_pairs(call);
    write_result(call, result);
}

void stream(IntersectCall call, PairStream& to) {
    constexpr std::size_t some = 2048;
    const auto pass_on = [&](NarrowScratch& scratch, std::size_t) {
        if (scratch.pairs.size() >= some) call.leaves.deliver(scratch);
    };
    const PairSink sink = pass_on;
    std::int64_t units = 0;
    call.sink = &sink;
    call.stream = &to;
    call.units = &units;
    measure(call);
    search_pairs(call);
}

bool any(IntersectCall call) {
    std::atomic<bool> found{false};
    const auto notice = [&](const NarrowScratch& scratch, std::size_t before) {
        if (scratch.pairs.size() > before) found.store(true, std::memory_order_relaxed);
    };
    const PairSink sink = notice;
    call.sink = &sink;
    call.enough = &found;
    measure(call);
    search_pairs(call);
    return found;
}

}  // namespace crumple::cpu
