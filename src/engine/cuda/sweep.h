#pragma once

// Stage `sweep`: pairs of rows whose boxes overlap ([MZ] sec. 3.1), and, while their records are at hand, the first
// filter of `narrow`: pairs that no plane separates go on.

#include "engine/cuda/layout.h"
#include "engine/cuda/runtime.h"
#include "engine/cuda/sort.h"
#include "model/scene.h"
#include "questions/intersect/plane_filter.h"

namespace crumple::cuda {

/// Which pairs of groups are wanted; `excluded` is sorted.
struct Rules {
    NarrowPolicy policy;
    bool by_group = false, between = false, within = false;  ///< groups that differ, groups that are equal
    const std::uint64_t* excluded = nullptr;
    int excluded_count = 0;
    friend bool operator==(const Rules&, const Rules&) = default;
};

/// The part of all units that one call sweeps: number `turn` of `turns`.
struct Slice {
    unsigned long long turn = 0, turns = 1;
};

/// `members`: their number, on the device.
void sweep(const Geometry& geometry, cudaStream_t stream, const Scene& scene, const Sorted& sorted,
           const unsigned long long* members, const Ownership& ownership, const Rules& rules,
           const List<Candidate>& survivors, const Slice& slice, Counters* counters);

}  // namespace crumple::cuda
