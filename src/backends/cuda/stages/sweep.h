#pragma once

// Stage `sweep`: pairs of rows whose boxes overlap ([MZ] sec. 3.1), that the leaf owns, whose groups (or bodies) are
// wanted, and that the question's filter keeps. A filter while a pair's rows are in the cache saves the list most of
// its length.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/sort.h"
#include "scene/prepared_scene.h"
#include "scene/wanted_pairs.h"

namespace crumple::cuda {

/// The part that one call sweeps of all units, or of every `step`th one: `count` of `turns` parts, from number `turn`
/// on. Ends early once `found`, unless it is null, is not 0; leaves out worlds with a hit, where these are counted.
struct Slice {
    unsigned long long turn = 0, turns = 1, count = 1;
    unsigned long long* found = nullptr;
    unsigned long long step = 1;
    WorldHits decided{};
};

/// `Filter`: has a function of the device keeps(has, candidate, room) that tells of the candidate of each lane that has
/// one whether it goes on; all lanes of a warp call it together, with a Filter::Room in shared memory. Lanes that have
/// none name another's. Defined in sweep_kernel.h.
template <class Filter>
void sweep(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
           const List<Unit>& units, const Ownership& ownership, const WantedPairs& wanted, const Filter& filter,
           const List<Candidate>& survivors, const Slice& slice, Counters* counters);

}  // namespace crumple::cuda
