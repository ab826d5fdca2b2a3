#pragma once

// Stage `sweep`: finds the pairs of rows whose boxes overlap ([MZ] sec. 3.1), that the leaf owns, whose groups (or
// bodies) the pair filter selects, and that the query's filter keeps. Filtering while a pair's rows are in the cache
// makes the list much shorter.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/sort.h"
#include "scene/pair_selection.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Share of the units that one call sweeps. It takes every `step`th unit, splits these into `turns` parts, and sweeps
/// `count` parts from part `turn` on. It ends early once *found is not 0, unless `found` is null, and skips worlds that
/// have a hit in `decided`.
struct Slice {
    unsigned long long turn = 0, turns = 1, count = 1;
    unsigned long long* found = nullptr;
    unsigned long long step = 1;
    WorldHits decided{};
};

/// Lists the survivors. `Filter` has a device function keeps(has, candidate, buffer), which returns true if `has` is
/// true and the lane's candidate is kept. All lanes of a warp call it together, with a Filter::Buffer in shared memory.
/// A lane without a candidate passes that of another lane. Defined in sweep_kernel.h.
template <class Filter>
void sweep(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
           const List<SweepUnit>& units, const Ownership& ownership, const PairSelection& wanted, const Filter& filter,
           const List<Candidate>& survivors, const Slice& slice, Counters* counters);

}  // namespace crumple::cuda
