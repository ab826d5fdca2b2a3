#include "backends/cpu/leaves.h"

#include <algorithm>

#include "backends/cpu/stages/align.h"
#include "base/float_environment.h"
#include "base/stopwatch.h"

namespace crumple::cpu {
namespace {

// Leaves with more interval tests than this are cut into tiles of about a quarter of this number, for several workers.
// In a stream, smaller ones that have all workers are tiled, too.
constexpr std::int64_t tile_work = std::int64_t{1} << 22;

// Cuts a leaf's rows into tiles with about the same number of interval tests. Writes the first row of each, then the
// end.
void cut_into_tiles(const SortedLeaf& leaf, Array<std::int64_t>& tile_begin) {
    const std::int64_t share = leaf.work / (4 * leaf.work / tile_work + 1) + 1;
    tile_begin.clear();
    std::int64_t work = 0;
    for (std::int64_t row = 0; row < leaf.rows; ++row) {
        if (work >= share * static_cast<std::int64_t>(tile_begin.size())) tile_begin.push_back(row);
        work += std::max<std::int64_t>(0, leaf.link[row].end - leaf.begin_of(row));
    }
    tile_begin.push_back(leaf.rows);
}

}  // namespace

void reserve_for_workers(const Call& call) {
    if (call.meter.limit > 0 || call.workers.workers() == 1) return;
    std::int64_t largest = 0;
    for (const Leaf& leaf : call.buffers.subdivision.leaves) largest = std::max(largest, leaf.size);
    largest = std::min<std::int64_t>(largest, 4 * call.options.leaf_size);
    for (std::size_t w = 0; w < call.buffers.worker.size(); ++w) {
        WorkerBuffers& worker = *call.buffers.worker[w];
        worker.members.reserve(static_cast<std::size_t>(largest));
        reserve(largest, call.scene.between, worker.sort, worker.leaf);
        call.query.reserve(call, largest, worker.leaf.rows, w);
    }
}

bool align_leaf(const Call& call, const Leaf& leaf, Ownership& ownership, std::size_t w) {
    const PreparedScene& scene = call.scene;
    WorkerBuffers& worker = *call.buffers.worker[w];
    Stopwatch watch;
    LeafMembers& members = worker.members;
    members.gather(scene, call.buffers.subdivision, leaf);
    if (members.size() < 2) return false;
    ownership.bits(members.triangle.data(), members.member.data(), members.size(), call.rule.groups_apart(),
                   members.lower.data());
    members.keep_members = !ownership.complete();
    const PointRows points = call.points();
    const std::int64_t ends = scene.moving ? scene.vertex_count() : 0;
    const BuildInput input{points,
                           scene.corners,
                           scene.triangle_count(),
                           members.triangle.data(),
                           members.size(),
                           leaf_frame(call.buffers.balls, points, scene.corners, members, call.options.method),
                           ends,
                           call.inflation,
                           mean_motion(points, scene.corners, ends, members)};
    const FlushToZero mode;
    call.query.build(input, members, w);
    worker.statistics[Stage::align] += watch.lap();
    return true;
}

void sort_leaf(const Call& call, std::size_t w) {
    WorkerBuffers& worker = *call.buffers.worker[w];
    Stopwatch watch;
    const FlushToZero mode;
    sort_leaf(worker.members, call.kernels, worker.sort, worker.leaf);
    call.query.place(worker.leaf, w);
    worker.statistics.interval_tests += worker.leaf.work;
    worker.statistics[Stage::sort] += watch.lap();
}

void sweep_leaf(const Call& call, const Ownership& ownership, bool in_tiles, std::size_t w) {
    WorkerBuffers& worker = *call.buffers.worker[w];
    const SortedLeaf& leaf = worker.leaf;
    // In a stream, each tile is a unit, and units must not depend on the number of workers.
    if (!in_tiles || (!call.units && (call.workers.workers() == 1 || leaf.work <= tile_work))) {
        call.query.sweep(leaf, ownership, 0, leaf.rows, w, w);
        return;
    }
    const Array<std::int64_t>& begin = worker.tile_begin;
    cut_into_tiles(leaf, worker.tile_begin);
    for_each_unit(call, begin.size() - 1, [&](std::size_t tile, std::size_t helper) {
        call.query.sweep(leaf, ownership, begin[tile], begin[tile + 1], w, helper);
    });
}

}  // namespace crumple::cpu
