#include "backends/cpu/intersections/stream_intersections.h"

#include <atomic>
#include <memory>

#include "results/filling_block.h"
#include "results/intersection_output.h"

namespace crumple::cpu {
namespace {

// The pairs that those of a list from `before` on stand for.
std::int64_t count(const Copies& copies, const Array<Pair>& pairs, std::size_t before) {
    if (copies.empty()) return static_cast<std::int64_t>(pairs.size() - before);
    std::int64_t sum = 0;
    for (std::size_t i = before; i < pairs.size(); ++i) sum += copies.count(pairs[i]);
    return sum;
}

// How contacts of one block are found beside the search.
constexpr auto one_after_another = [](std::size_t n, auto task) {
    for (std::size_t i = 0; i < n; ++i) task(i);
};

}  // namespace

void stream_in_order(IntersectCall call, std::int64_t most, BlockSink sink) {
    std::atomic<std::int64_t> pairs{0};
    std::atomic<bool> enough{false};
    const auto told = [&](const Array<Pair>& found, std::size_t before) {
        const std::int64_t more = count(call.leaves.copies(), found, before);
        if (pairs.fetch_add(more, std::memory_order_relaxed) + more > most)
            enough.store(true, std::memory_order_relaxed);
    };
    const PairSink counted = told;
    PairRange range;
    call.sink = &counted;
    call.enough = &enough;
    call.range = &range;
    Intersections block = metered(&call.meter);
    const auto answer = [&] {
        pairs = 0;
        enough = false;
        search_pairs(call);
        if (enough || pairs == 0) return pairs.load();
        write_result(call, block);
        for (auto* flags : {&block.hit, &block.hit_second}) flags->clear();
        block.offsets.clear();
        sink(block);
        return pairs.load();
    };
    const std::int64_t first = call.scene.triangles[0], all = call.scene.triangle_count();
    measure(call);
    const auto seconds_of = [&](std::int64_t id) { return IdRange{call.scene.between ? first : id + 1, all}; };
    const auto of_firsts = [&](IdRange ids) {
        range = {ids, seconds_of(ids.begin)};
        return answer();
    };
    const auto of_one = [&](std::int64_t id) {
        const auto of_seconds = [&](IdRange ids) {
            range = {{id, id + 1}, ids};
            return answer();
        };
        for_each_range(seconds_of(id), most, of_seconds, [](std::int64_t) {});  // two triangles are one pair
    };
    for_each_range({0, first}, most, of_firsts, of_one);
}

void stream_as_found(IntersectCall call, std::int64_t most, BlockSink sink) {
    std::atomic<std::int64_t> rational{0};
    const auto meet = [&](Intersections& block) {
        if (call.query.contacts()) rational += contacts_of_pairs(call.scene, block, one_after_another);
    };
    FillingBlock<Intersections> filling(most, {[&] { return std::make_unique<Intersections>(metered(&call.meter)); },
                                               meet, sink, [](Intersections& block) { block.pairs.clear(); }});
    const auto take = [&](Array<Pair>& found, std::size_t) {
        const auto second = static_cast<std::int32_t>(call.scene.between ? call.scene.triangles[0] : 0);
        FillingBlock<Intersections>::Writer writer(filling);
        for (const Pair& first : found)
            call.leaves.copies().for_each(first, call.cancellation, [&](Pair pair) {
                writer.add(1, [&](Intersections& block, std::size_t, std::size_t) {
                    block.pairs.push_back({pair.a, pair.b - second});
                });
            });
        found.clear();
    };
    const PairSink taken = take;
    call.sink = &taken;
    measure(call);
    search_pairs(call);
    filling.finish();
    call.statistics.rational_contacts = rational;
}

}  // namespace crumple::cpu
