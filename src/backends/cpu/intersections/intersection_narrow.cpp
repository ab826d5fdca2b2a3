#include "backends/cpu/intersections/intersection_narrow.h"

#include <algorithm>

#include "base/float_environment.h"
#include "base/stopwatch.h"

namespace crumple::cpu {
namespace {

// Turns one chunk's verdicts into pairs: drops pairs that the leaf does not own or the pair filter excludes, and
// decides undecided ones exactly.
void decide(const NarrowContext& context, const SortedLeaf& leaf, const Ownership& ownership, NarrowScratch& scratch) {
    const CandidateChunk& candidates = scratch.candidates;
    const auto ours = [&](std::int64_t row, std::int64_t column) {
        const std::int32_t a = leaf.link[row].triangle, b = leaf.link[column].triangle;
        if (!ownership.complete() && !ownership.owns(a, leaf.member[row], b, leaf.member[column])) return false;
        return context.rule.trivial() || context.rule(context.scene.group(a), context.scene.group(b));
    };
    const bool check = !ownership.complete() || !context.rule.trivial();
    Array<std::uint32_t>& hits = scratch.verdicts.hit;
    const Array<std::uint32_t>& undecided = scratch.verdicts.undecided;
    if (check) {
        const auto foreign = [&](std::uint32_t packed) {
            return !ours(candidates.rows + (packed & 0xffff), candidates.columns + (packed >> 16));
        };
        hits.resize(static_cast<std::size_t>(std::remove_if(hits.begin(), hits.end(), foreign) - hits.begin()));
    }
    const std::size_t before = scratch.pairs.size();
    scratch.pairs.grow_by(hits.size() + undecided.size() + padding);
    Pair* next = scratch.pairs.data() + before;
    context.kernels.triangles_of_pairs(hits.data(), hits.size(), leaf.link.data() + candidates.rows,
                                       leaf.link.data() + candidates.columns, next);
    next += hits.size();
    DecisionCounts counts;
    for (const std::uint32_t packed : undecided) {
        const std::int64_t row = candidates.rows + (packed & 0xffff), column = candidates.columns + (packed >> 16);
        if (check && !ours(row, column)) continue;
        const std::int32_t a = leaf.link[row].triangle, b = leaf.link[column].triangle;
        if (!context.decides || collide(context.scene.triangle(a), context.scene.triangle(b), context.query.neighbours,
                                        context.query.kind, counts))
            *next++ = {std::min(a, b), std::max(a, b)};
    }
    scratch.pairs.resize(static_cast<std::size_t>(next - scratch.pairs.data()));
    if (context.sink) (*context.sink)(scratch, before);
    scratch.statistics.exact_tests += counts.exact;
    scratch.statistics.rational_tests += counts.rational;
}

}  // namespace

void sweep_and_narrow(const NarrowContext& context, const SortedLeaf& leaf, const LeafRecords& records,
                      const Ownership& ownership, std::int64_t first, std::int64_t last, NarrowScratch& scratch) {
    const NarrowPolicy policy = policy_of(context.query.neighbours, context.query.kind);
    Statistics& statistics = scratch.statistics;
    CandidateChunk& candidates = scratch.candidates;
    candidates.group = context.kernels.group;
    Stopwatch watch;
    const auto stop = [&] {
        watch.lap();
        return context.stop();
    };
    const auto narrow = [&] {
        statistics[Stage::sweep] += watch.lap();
        if (candidates.pairs == 0) return;
        statistics.box_overlaps += candidates.pairs;
        scratch.most_candidates = std::max(scratch.most_candidates, candidates.count);
        {
            const FlushToZero mode;
            context.kernels.filter(records.sorted.data(), candidates, context.points, policy, records.reach,
                                   scratch.verdicts);
        }
        statistics.edge_tests += scratch.verdicts.edge_tests;
        statistics.double_tests += scratch.verdicts.double_tests;
        decide(context, leaf, ownership, scratch);
        statistics[Stage::narrow] += watch.lap();
    };
    sweep_chunks(context.stages, leaf, first, last, candidates, stop, narrow);
    std::size_t next = records.stars.first_pair(first);
    while (!stop() && records.stars.list(leaf, last, next, candidates)) narrow();
}

}  // namespace crumple::cpu
