#pragma once

// The stages in the service of one question: which triangles intersect.

#include "backends/cpu/intersections/intersection_leaves.h"
#include "backends/cpu/order.h"
#include "backends/cpu/stages/output.h"
#include "backends/pair_budget.h"

namespace crumple::cpu {

/// What is asked, and where the pairs go.
struct IntersectCall : Call {
    const IntersectionQuery& query;
    IntersectLeaves& leaves;  ///< the same as `question`
    OutputScratch& output;

    const PairSink* sink = nullptr;       ///< see NarrowContext
    std::atomic<bool>* enough = nullptr;  ///< see NarrowContext
    PairStream* stream = nullptr;         ///< see IntersectLeaves::Asked
};

/// As search() of order.h: pairs gather with the workers, unless the sink takes them.
void search_pairs(const IntersectCall& call);

/// Stage `output`: the result from the pairs that the workers hold.
void write_result(const IntersectCall& call, Intersections& result);

/// What belongs to the pairs of `result`: where they meet, if that is asked for.
void write_contacts(const IntersectCall& call, Intersections& result);

/// All stages.
void find(const IntersectCall& call, Intersections& result);

/// All stages but `output`: gives all pairs to a stream.
void stream(IntersectCall call, PairStream& to);

/// Whether there is any pair; ends at the first.
bool any(IntersectCall call);

}  // namespace crumple::cpu
