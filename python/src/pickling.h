#pragma once

// Results and statistics as plain values: taken apart for pickle, put together again, copied.

#include <nanobind/nanobind.h>

#include "crumple/intersections.h"

namespace crumple::python {

/// Everything in it, by name; Statistics are equal if it is.
nanobind::dict state_of(const Statistics& statistics);

/// Throws InvalidType or Error (invalid_argument) for what state_of does not give.
Statistics statistics_of(nanobind::handle state);

void bind_pickling(nanobind::module_& module);

}  // namespace crumple::python
