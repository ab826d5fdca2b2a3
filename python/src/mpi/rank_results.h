#pragma once

// Local rows of a rank for Python: a result that Python owns, as NumPy views.

#include <nanobind/nanobind.h>

#include "crumple/distributed.h"

namespace crumple::python {

/// Result of a rank: the storage of the class of the same name in crumple.mpi. NumPy views of its arrays keep it alive.
template <class Result>
struct RankShown {
    Result result;
    const Result& found() const { return result; }
};

void bind_rank_results(nanobind::module_& module);

}  // namespace crumple::python
