#pragma once

// States of statistics for pickle and comparison, and restored results.

#include <nanobind/nanobind.h>

#include "crumple/intersections.h"

namespace crumple::python {

/// Returns all members by name. Statistics are equal if their states are.
nanobind::dict state_of(const Statistics& statistics);

/// Converts a state. Throws InvalidType or Error (invalid_argument) for a state that state_of cannot return.
Statistics statistics_of(nanobind::handle state);

void bind_pickling(nanobind::module_& module);

}  // namespace crumple::python
