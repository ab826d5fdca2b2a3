#pragma once

// Stage `sweep`: pairs of rows whose boxes overlap ([MZ] sec. 3.1), that the leaf owns, whose groups are wanted, and
// that the question's filter keeps. A filter while a pair's rows are in the cache saves the list most of its length.

#include "engine/cuda/layout.h"
#include "engine/cuda/runtime.h"
#include "engine/cuda/sort.h"
#include "model/group_rule.h"
#include "model/scene.h"

namespace crumple::cuda {

/// The part of all units that one call sweeps: `count` of `turns` parts, from number `turn` on. Ends early once
/// `found`, unless it is null, is not 0.
struct Slice {
    unsigned long long turn = 0, turns = 1, count = 1;
    unsigned long long* found = nullptr;
};

/// `Filter`: a function of the device that tells of a Candidate whether it goes
/// on. Defined in sweep_kernel.h.
template <class Filter>
void sweep(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Sorted& sorted,
           const List<Unit>& units, const Ownership& ownership, const WantedGroups& groups, const Filter& filter,
           const List<Candidate>& survivors, const Slice& slice, Counters* counters);

}  // namespace crumple::cuda
