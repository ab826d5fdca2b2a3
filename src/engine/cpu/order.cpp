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
    for (auto& worker : call.buffers.worker) {
        worker->narrow.pairs.clear();
        worker->narrow.statistics = {};
    }
    if (call.frugal) call.buffers.warm = {};  // each pass makes the same leaves
    call.buffers.rule.prepare(call.query, call.scene.bodies);
}

// Which triangles are looked at.
void choose_triangles(const Call& call, bool repeats_corner) {
    Buffers& b = call.buffers;
    b.included.clear();
    if (call.scene.between) exclude_far(call.scene, call.workers, b.balls, b.included);
    b.copies.clear();
    if (repeats_corner) {
        b.copies.find(call.scene, b.rule, b.included_or_null());
        b.copies.leave_out(b.included);
    }
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

void find_pairs(const Call& call) {
    const Scene& scene = call.scene;
    const StageKernels& kernels = call.kernels;
    Workers& workers = call.workers;
    Statistics& statistics = call.statistics;
    Buffers& b = call.buffers;
    const std::int64_t n = scene.triangle_count();
    Stopwatch watch;
    begin(call);
    const bool repeats_corner = compute_bounds(scene, kernels, workers, b.points, b.balls);
    choose_triangles(call, repeats_corner);
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
            Ownership ownership(scene, call.levels, b.subdivision, leaf);
            if (!align_leaf(call, context.points, leaf, ownership, worker)) return;
            sort_leaf(call, worker);
            sweep_leaf(call, context, ownership, in_tiles, worker);  // and narrow
        });
        watch.lap();
    }
    for (const auto& worker : b.worker) add(worker->narrow.statistics, statistics);
}

void find(const Call& call, Collisions& result) {
    find_pairs(call);
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
    call.statistics.rational_contacts = contacts_of_pairs(call.scene, result, [&](std::size_t n, auto task) {
        call.workers.parallel_for((n + batch - 1) / batch, [&](std::size_t b, std::size_t) {
            for (std::size_t i = b * batch; i < std::min(n, (b + 1) * batch); ++i) task(i);
        });
    });
}

}  // namespace crumple::cpu
