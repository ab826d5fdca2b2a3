#pragma once

// Runs the stages to find which triangles intersect.

#include "backends/cpu/intersections/intersection_leaves.h"
#include "backends/cpu/order.h"
#include "backends/cpu/stages/output.h"
#include "backends/pair_budget.h"
#include "crumple/clustering.h"

namespace crumple::cpu {

/// Call of an intersection query, and the destination of its pairs.
struct IntersectCall : Call {
    const IntersectionQuery& query;
    IntersectLeaves& leaves;  ///< the object that Call::query, hidden by `query` above, refers to
    OutputScratch& output;
    bool decides = true;  ///< see NarrowContext

    const PairSink* sink = nullptr;       ///< see NarrowContext
    std::atomic<bool>* enough = nullptr;  ///< see NarrowContext
    PairStream* stream = nullptr;         ///< receives the pairs of each unit (queries/row_stream.h); null: no stream
};

/// Runs search() of order.h. Pairs stay in `leaves`, except for those that the sink removes.
void search_pairs(const IntersectCall& call);

/// Runs stage `output`: makes the result from the pairs in `leaves`.
void write_result(const IntersectCall& call, Intersections& result);

/// Computes the contacts of the pairs in `result`, if the query requests them.
void write_contacts(const IntersectCall& call, Intersections& result);

/// Runs all stages.
void find(const IntersectCall& call, Intersections& result);

/// Runs all stages but `output`, and delivers all pairs to a stream.
void stream(IntersectCall call, PairStream& to);

/// Runs stages `bounds` and `subdivide`, and computes the frames of `align`.
Clustering cluster(const IntersectCall& call);

/// Returns true if there is any pair. Ends soon after the first one.
bool any(IntersectCall call);

}  // namespace crumple::cpu
