#pragma once

// A rank's rows on their way out: a result that Python owns, shown as NumPy arrays without a copy.

#include <nanobind/nanobind.h>

#include "crumple/distributed.h"

namespace crumple::python {

/// One rank's result that the class of the same name in crumple.mpi shows. Its arrays hold it.
template <class Result>
struct RankShown {
    Result result;
    const Result& found() const { return result; }
};

void bind_rank_results(nanobind::module_& module);

}  // namespace crumple::python
