#include "engine/cpu/leaves.h"

#include <algorithm>

#include "base/float_environment.h"
#include "base/stopwatch.h"
#include "engine/cpu/align.h"

namespace crumple::cpu {
namespace {

// Leaves with more interval tests than this are cut into tiles of about a quarter of it, for several workers.
constexpr std::int64_t tile_work = std::int64_t{1} << 22;

// Tiles of rows with about the same number of interval tests: their prefix sum tells where to cut.
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

NarrowContext narrow_context(const Call& call) {
    const Points& points = call.buffers.points;
    const PointRows rows =
        call.scene.float32 ? PointRows{points.f.data(), nullptr} : PointRows{nullptr, points.d.data()};
    // The SIMD filters form 4 vertex in 32 bits.
    const bool huge = call.scene.vertex_count() >= std::int64_t{1} << 29;
    return {call.scene, call.query,        call.buffers.rule, call.kernels, huge ? scalar_intersect : call.intersect,
            rows,       call.cancellation, call.sink,         call.enough};
}

void make_room_for_workers(const Call& call) {
    const int workers = call.workers.workers();
    if (call.meter.limit > 0 || workers == 1) return;
    std::int64_t largest = 0, most = 0;
    for (const Leaf& leaf : call.buffers.subdivision.leaves) largest = std::max(largest, leaf.size);
    for (const auto& worker : call.buffers.worker) most = std::max(most, worker->narrow.most_candidates);
    largest = std::min<std::int64_t>(largest, 4 * call.options.leaf_size);
    const std::size_t share = 2 * call.buffers.pairs_before / static_cast<std::size_t>(workers);
    for (const auto& worker : call.buffers.worker) {
        worker->members.make_room(static_cast<std::size_t>(largest));
        make_room(largest, call.scene.between, worker->sort, worker->leaf);
        worker->records.make_room(largest, worker->leaf.rows);
        make_room(worker->leaf.rows, worker->narrow.candidates);
        if (most > 0) worker->narrow.verdicts.make_room(most);
        worker->narrow.pairs.reserve(share);
    }
}

bool align_leaf(const Call& call, const PointRows& points, const Leaf& leaf, Ownership& ownership,
                WorkerBuffers& worker) {
    const Scene& scene = call.scene;
    Stopwatch watch;
    LeafMembers& members = worker.members;
    members.gather(scene, call.buffers.subdivision, leaf);
    if (members.size() < 2) return false;
    ownership.bits(members.triangle.data(), members.member.data(), members.size(), call.buffers.rule.groups_apart(),
                   members.lower.data());
    members.keep_members = !ownership.complete();
    const BuildInput input{points,
                           scene.corners,
                           scene.triangle_count(),
                           members.triangle.data(),
                           members.size(),
                           leaf_frame(call.buffers.balls, points, scene.corners, members)};
    const FlushToZero mode;
    worker.records.build(call.intersect, input, members);
    worker.narrow.statistics[Stage::align] += watch.lap();
    return true;
}

void sort_leaf(const Call& call, WorkerBuffers& worker) {
    Stopwatch watch;
    const FlushToZero mode;
    sort_leaf(worker.members, call.kernels, worker.sort, worker.leaf);
    worker.records.sort(call.intersect, worker.leaf);
    worker.narrow.statistics.interval_tests += worker.leaf.work;
    worker.narrow.statistics[Stage::sort] += watch.lap();
}

void sweep_leaf(const Call& call, const NarrowContext& context, const Ownership& ownership, bool in_tiles,
                WorkerBuffers& worker) {
    const SortedLeaf& leaf = worker.leaf;
    if (!in_tiles || call.workers.workers() == 1 || leaf.work <= tile_work) {
        sweep_and_narrow(context, leaf, worker.records, ownership, 0, leaf.rows, worker.narrow);
        return;
    }
    const Array<std::int64_t>& begin = worker.tile_begin;
    cut_into_tiles(leaf, worker.tile_begin);
    call.workers.parallel_for(begin.size() - 1, [&](std::size_t tile, std::size_t w) {
        sweep_and_narrow(context, leaf, worker.records, ownership, begin[tile], begin[tile + 1],
                         call.buffers.worker[w]->narrow);
    });
}

}  // namespace crumple::cpu
