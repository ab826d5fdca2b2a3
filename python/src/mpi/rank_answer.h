#pragma once

// A rank's rows on their way out: a DistributedCollisions, DistributedWorldCollisions, DistributedImpacts or
// DistributedNearby that Python owns, shown as NumPy arrays without a copy.

#include <nanobind/nanobind.h>

#include "crumple/distributed.h"

namespace crumple::python {

/// What a crumple.mpi.Result shows. Its arrays hold it.
struct RankAnswer {
    DistributedCollisions found;
    bool has_contacts = false;
};

/// What a crumple.mpi.WorldResult shows.
struct RankWorldAnswer {
    DistributedWorldCollisions found;
    Wants wants{};
};

/// What a crumple.mpi.Impacts or crumple.mpi.Nearby shows.
template <class Found, class Wants>
struct RankFeatures {
    Found found;
    Wants wants{};
    bool has_closest = false;  ///< of nearness
    bool of_world = false;
};
using RankImpacts = RankFeatures<DistributedImpacts, MotionWants>;
using RankNearby = RankFeatures<DistributedNearby, NearWants>;

void bind_rank_answer(nanobind::module_& module);

}  // namespace crumple::python
