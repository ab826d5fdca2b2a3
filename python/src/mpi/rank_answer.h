#pragma once

// A rank's rows on their way out: a DistributedCollisions that Python owns, shown as NumPy arrays without a copy.

#include <nanobind/nanobind.h>

#include "crumple/distributed.h"

namespace crumple::python {

/// What a crumple.mpi.Result shows. Its arrays hold it.
struct RankAnswer {
    DistributedCollisions found;
    bool has_contacts = false;
};

void bind_rank_answer(nanobind::module_& module);

}  // namespace crumple::python
