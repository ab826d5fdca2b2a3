#pragma once

// A rank's rows on their way out: a DistributedIntersections, DistributedIntersections, DistributedImpacts or
// DistributedProximities that Python owns, shown as NumPy arrays without a copy.

#include <nanobind/nanobind.h>

#include "crumple/distributed.h"

namespace crumple::python {

/// What a crumple.mpi.Result shows. Its arrays hold it.
struct RankAnswer {
    DistributedIntersections found;
    bool has_contacts = false;
};

/// What a crumple.mpi.WorldResult shows.
struct RankWorldAnswer {
    DistributedIntersections found;
    Output output{};
};

/// What a crumple.mpi.Impacts or crumple.mpi.Nearby shows.
template <class Found, class Output>
struct RankFeatures {
    Found found;
    Output output{};
    bool has_closest = false;  ///< of nearness
    bool of_world = false;
};
using RankImpacts = RankFeatures<DistributedImpacts, Output>;
using RankNearby = RankFeatures<DistributedProximities, Output>;

void bind_rank_answer(nanobind::module_& module);

}  // namespace crumple::python
