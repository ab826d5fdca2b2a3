#include "engine/cpu/order.h"

#include <algorithm>

#include "base/stopwatch.h"
#include "engine/cpu/bounds.h"
#include "engine/cpu/leaves.h"
#include "engine/output.h"

namespace crumple::cpu {
namespace {

void begin(const Call& call) {
    Statistics& statistics = call.statistics;
    statistics.backend = "cpu";
    statistics.simd = call.kernels.name;
    statistics.threads = call.workers.workers();
    statistics.leaves = statistics.members = 0;
    call.buffers.rule.prepare(call.query, call.scene.bodies);
}

void forget_pairs(const Call& call) {
    for (auto& worker : call.buffers.worker) {
        worker->narrow.pairs.clear();
        worker->narrow.statistics = {};
    }
}

// Which triangles are looked at, and the levels above them that say whose pairs are wanted.
Levels choose_triangles(const Call& call) {
    Buffers& b = call.buffers;
    Levels levels = call.levels;
    b.included.clear();
    if (call.scene.between) exclude_far(call.scene, call.workers, b.balls, b.included);
    if (call.range) levels.add(exclude_others(*call.range, call.workers, b.balls, b.included, b.range_masks));
    b.copies.clear();
    if (b.repeats_corner) {
        b.copies.find(call.scene, b.rule, levels, b.included_or_null());
        b.copies.leave_out(b.included);
    }
    return levels;
}

// How many leaves are done one after another, each on all workers: where a task cannot start a loop, those that are far
// larger than others are usual, or the only one. The largest come first.
std::size_t leaves_alone(const Call& call) {
    const Array<Leaf>& leaves = call.buffers.subdivision.leaves;
    if (call.workers.nests()) return 0;
    if (leaves.size() == 1) return 1;
    const auto large = [&](const Leaf& leaf) { return leaf.size > 4 * std::int64_t{call.options.leaf_size}; };
    return static_cast<std::size_t>(std::partition_point(leaves.begin(), leaves.end(), large) - leaves.begin());
}

/// Calls work(leaf, worker, in_tiles): whether other workers may help with the leaf.
template <class Work>
void for_each_leaf(const Call& call, Work work) {
    const Array<Leaf>& leaves = call.buffers.subdivision.leaves;
    const auto on_worker = [&](std::size_t l, std::size_t w, bool in_tiles) {
        work(leaves[l], *call.buffers.worker[w], in_tiles);
    };
    if (call.frugal) {
        for (std::size_t l = 0; l < leaves.size(); ++l) on_worker(l, 0, false);
    } else {
        const std::size_t alone = leaves_alone(call);
        for (std::size_t l = 0; l < alone; ++l) on_worker(l, 0, true);
        call.workers.parallel_for(leaves.size() - alone,
                                  [&](std::size_t l, std::size_t w) { on_worker(alone + l, w, call.workers.nests()); });
    }
    call.statistics.leaves += static_cast<std::int64_t>(leaves.size());
    for (const Leaf& leaf : leaves) call.statistics.members += leaf.size;
}

}  // namespace

void measure(const Call& call) {
    Buffers& b = call.buffers;
    Stopwatch watch;
    begin(call);
    b.repeats_corner = compute_bounds(call.scene, call.kernels, call.workers, b.points, b.balls);
    call.statistics[Stage::bounds] += watch.lap();
}

void search(const Call& call) {
    const Scene& scene = call.scene;
    const StageKernels& kernels = call.kernels;
    Workers& workers = call.workers;
    Statistics& statistics = call.statistics;
    Buffers& b = call.buffers;
    const std::int64_t n = scene.triangle_count();
    Stopwatch watch;
    forget_pairs(call);
    if (call.frugal) b.warm = {};  // each pass makes the same leaves
    const Levels levels = choose_triangles(call);
    statistics[Stage::bounds] += watch.lap();
    place_clusters(b.balls, n, b.included_or_null(), call.options, kernels, workers, b.warm, b.subdivision);
    statistics.clusters = b.subdivision.clusters;

    const NarrowContext context = narrow_context(call);
    const int together = call.frugal ? 1 : b.subdivision.clusters;
    for (int k = 0; k < b.subdivision.clusters && !context.stop(); k += together) {
        gather_leaves(b.balls, n, k, k + together, call.options, kernels, workers, b.warm, b.subdivision);
        statistics[Stage::subdivide] += watch.lap();
        if (!call.frugal) make_room_for_workers(call);
        for_each_leaf(call, [&](const Leaf& leaf, WorkerBuffers& worker, bool in_tiles) {
            if (leaf.size < 2 || context.stop()) return;
            Ownership ownership(scene, levels, b.subdivision, leaf);
            if (!align_leaf(call, context.points, leaf, ownership, worker)) return;
            sort_leaf(call, worker);
            sweep_leaf(call, context, ownership, in_tiles, worker);  // and narrow
        });
        watch.lap();
    }
    for (const auto& worker : b.worker) add(worker->narrow.statistics, statistics);
}

void write_result(const Call& call, Collisions& result) {
    Buffers& b = call.buffers;
    Stopwatch watch;
    if (!b.copies.empty())
        call.workers.parallel_for(b.worker.size(), [&](std::size_t w, std::size_t) {
            b.copies.expand(b.worker[w]->narrow.pairs, call.cancellation);
        });
    write_output(call.scene, call.workers, b.found, b.output, result);
    b.pairs_before = result.pairs.size();
    write_contacts(call, result);
    call.statistics[Stage::output] += watch.lap();
}

void write_contacts(const Call& call, Collisions& result) {
    result.contacts.kinds.clear();
    result.contacts.offsets.clear();
    result.contacts.points.clear();
    if (!call.query.contacts) return;
    constexpr std::size_t batch = 256;
    call.statistics.rational_contacts += contacts_of_pairs(call.scene, result, [&](std::size_t n, auto task) {
        call.workers.parallel_for((n + batch - 1) / batch, [&](std::size_t b, std::size_t) {
            for (std::size_t i = b * batch; i < std::min(n, (b + 1) * batch); ++i) task(i);
        });
    });
}

void find(const Call& call, Collisions& result) {
    measure(call);
    search(call);
    write_result(call, result);
}

bool any(Call call) {
    std::atomic<bool> found{false};
    const auto notice = [&](const Array<Pair>& pairs, std::size_t before) {
        if (pairs.size() > before) found.store(true, std::memory_order_relaxed);
    };
    const PairSink sink = notice;
    call.sink = &sink;
    call.enough = &found;
    measure(call);
    search(call);
    return found;
}

}  // namespace crumple::cpu
