#include "backends/cpu/intersections/intersection_leaves.h"

#include <algorithm>

#include "backends/cpu/order.h"
#include "results/intersection_output.h"

namespace crumple::cpu {

IntersectLeaves::IntersectLeaves(MemoryMeter* meter, int workers, const IntersectKernels& kernels)
    : kernels_(kernels), copies_(meter) {
    for (int w = 0; w < workers; ++w) {
        worker_.push_back(std::make_unique<Worker>(meter));
        found_.push_back(&worker_.back()->narrow.pairs);
    }
}

void IntersectLeaves::begin(const Call& call) {
    for (const auto& worker : worker_) {
        worker->narrow.pairs.clear();
        worker->narrow.statistics = {};
    }
    // The SIMD filters compute 4 * vertex in 32 bits.
    const bool huge = call.scene.vertex_count() >= std::int64_t{1} << 29;
    context_.emplace(NarrowContext{call.scene, *asked_.query, call.rule, call.kernels,
                                   huge ? scalar_intersect : kernels_, call.points(), call.cancellation, asked_.decides,
                                   asked_.sink, asked_.enough});
}

void IntersectLeaves::leave_out(const Call& call, Levels& levels) {
    Buffers& b = call.buffers;
    copies_.clear();
    if (!b.repeats_corner) return;
    copies_.find(call.scene, call.rule, levels, b.included_or_null());
    copies_.leave_out(b.included);
}

// Also reserves memory for pairs: twice the worker's average share of the pairs of the last result.
void IntersectLeaves::reserve(const Call&, std::int64_t members, std::int64_t rows, std::size_t worker) {
    std::int64_t most = 0;
    for (const auto& each : worker_) most = std::max(most, each->narrow.most_candidates);
    Worker& mine = *worker_[worker];
    mine.records.reserve(members, rows);
    cpu::reserve(rows, mine.narrow.candidates);
    if (most > 0) mine.narrow.verdicts.reserve(most);
    mine.narrow.pairs.reserve(2 * pairs_before / worker_.size());
}

void IntersectLeaves::build(const BuildInput& input, LeafMembers& members, std::size_t worker) {
    worker_[worker]->records.build(kernels_, input, members);
}

void IntersectLeaves::place(const SortedLeaf& leaf, std::size_t worker) {
    worker_[worker]->records.sort(kernels_, leaf);
}

void IntersectLeaves::sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
                            std::size_t builder, std::size_t worker) {
    sweep_and_narrow(*context_, leaf, worker_[builder]->records, ownership, first, last, worker_[worker]->narrow);
}

void IntersectLeaves::deliver(NarrowScratch& scratch) {
    Array<Pair>& pairs = scratch.pairs;
    if (pairs.empty()) return;
    const PreparedScene& scene = context_->scene;
    if (!copies_.empty()) copies_.expand(pairs, context_->cancellation);
    const auto second = static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
    for (Pair& pair : pairs) pair.b -= second;
    asked_.stream->add(scratch.unit, pairs);
}

void IntersectLeaves::end_unit(std::size_t worker) {
    deliver(worker_[worker]->narrow);
    asked_.stream->finish(worker_[worker]->narrow.unit);
}

void IntersectLeaves::finish(Statistics& statistics) {
    for (const auto& worker : worker_) add(worker->narrow.statistics, statistics);
}

}  // namespace crumple::cpu
