#include "backends/cpu/order.h"

#include <algorithm>

#include "backends/cpu/leaves.h"
#include "backends/cpu/stages/bounds.h"
#include "base/stopwatch.h"
#include "results/intersection_output.h"

namespace crumple::cpu {
namespace {

void begin(const Call& call) {
    Statistics& statistics = call.statistics;
    statistics.backend = "cpu";
    statistics.simd = call.kernels.name;
    statistics.threads = call.workers.workers();
    statistics.leaves = statistics.members = 0;
}

// Selects the triangles to search (Buffers::included). Returns the levels of subdivision above the scene. Together with
// the scene's own levels, they decide which pairs a leaf owns.
Levels choose_triangles(const Call& call) {
    Buffers& b = call.buffers;
    Levels levels = call.levels;
    b.included.clear();
    if (call.scene.between) exclude_far(call.scene, call.workers, b.balls, b.included);
    call.query.leave_out(call, levels);
    return levels;
}

// Returns how many leaves, the largest first, run one after another, each on all workers: those far larger than usual,
// or the only one. Needed if a task cannot start a parallel loop, and in streams, where each tile of these leaves is a
// unit.
std::size_t leaves_alone(const Call& call) {
    const Array<Leaf>& leaves = call.buffers.subdivision.leaves;
    if (call.workers.nests() && !call.units) return 0;
    if (leaves.size() == 1) return 1;
    const auto large = [&](const Leaf& leaf) { return leaf.size > 4 * std::int64_t{call.options.leaf_size}; };
    return static_cast<std::size_t>(std::partition_point(leaves.begin(), leaves.end(), large) - leaves.begin());
}

/// Calls work(leaf, worker, in_tiles) for each leaf. `in_tiles`: other workers may help with the leaf.
template <class Work>
void for_each_leaf(const Call& call, Work work) {
    const Array<Leaf>& leaves = call.buffers.subdivision.leaves;
    if (call.low_memory) {
        if (call.units)
            for_each_unit(call, leaves.size(), [&](std::size_t l, std::size_t w) { work(leaves[l], w, false); });
        else
            for (const Leaf& leaf : leaves) work(leaf, std::size_t{0}, false);
    } else {
        const std::size_t alone = leaves_alone(call);
        for (std::size_t l = 0; l < alone; ++l) work(leaves[l], std::size_t{0}, true);
        for_each_unit(call, leaves.size() - alone, [&](std::size_t l, std::size_t w) {
            work(leaves[alone + l], w, call.workers.nests() && !call.units);
        });
    }
    call.statistics.leaves += static_cast<std::int64_t>(leaves.size());
    for (const Leaf& leaf : leaves) call.statistics.members += leaf.size;
}

}  // namespace

void measure(const Call& call) {
    Buffers& b = call.buffers;
    Stopwatch watch;
    begin(call);
    b.repeats_corner = compute_bounds(call.scene, call.inflation, call.kernels, call.workers, b.points, b.balls);
    call.statistics[Stage::bounds] += watch.lap();
}

void subdivide(const Call& call) {
    Buffers& b = call.buffers;
    const std::int64_t n = call.scene.triangle_count();
    call.query.begin(call);
    choose_triangles(call);
    place_clusters(b.balls, n, b.included_or_null(), call.options, call.kernels, call.workers, b.warm, b.subdivision);
    gather_leaves(b.balls, n, 0, b.subdivision.clusters, call.options, call.kernels, call.workers, b.warm,
                  b.subdivision);
}

void search(const Call& call) {
    const PreparedScene& scene = call.scene;
    const StageKernels& kernels = call.kernels;
    Workers& workers = call.workers;
    Statistics& statistics = call.statistics;
    LeafQuery& query = call.query;
    Buffers& b = call.buffers;
    const std::int64_t n = scene.triangle_count();
    Stopwatch watch;
    query.begin(call);
    for (const auto& worker : b.worker) worker->statistics = {};
    if (call.low_memory) b.warm = {};  // a search may run twice, to count and to fill, and needs the same leaves
    const Levels levels = choose_triangles(call);
    statistics[Stage::bounds] += watch.lap();
    place_clusters(b.balls, n, b.included_or_null(), call.options, kernels, workers, b.warm, b.subdivision);
    statistics.clusters = b.subdivision.clusters;

    const int together = call.low_memory ? 1 : b.subdivision.clusters;
    for (int k = 0; k < b.subdivision.clusters && !query.stop(); k += together) {
        gather_leaves(b.balls, n, k, k + together, call.options, kernels, workers, b.warm, b.subdivision);
        statistics[Stage::subdivide] += watch.lap();
        if (!call.low_memory) reserve_for_workers(call);
        for_each_leaf(call, [&](const Leaf& leaf, std::size_t worker, bool in_tiles) {
            if (leaf.size < 2 || query.stop()) return;
            Ownership ownership(scene, levels, b.subdivision, leaf);
            if (!align_leaf(call, leaf, ownership, worker)) return;
            sort_leaf(call, worker);
            sweep_leaf(call, ownership, in_tiles, worker);  // runs `narrow`, too
        });
        watch.lap();
    }
    if (call.may_lose && b.subdivision.may_lose) *call.may_lose = true;
    for (const auto& worker : b.worker) add(worker->statistics, statistics);
    query.finish(statistics);
}

}  // namespace crumple::cpu
