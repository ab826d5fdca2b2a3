#pragma once

// States of Statistics objects, for pickle and comparison, and restoring of unpickled results.

#include <nanobind/nanobind.h>

#include "crumple/intersections.h"

namespace crumple::python {

/// Returns all members by name. Statistics are equal if their states are.
nanobind::dict state_of(const Statistics& statistics);

/// Converts a state that state_of() returned. Throws InvalidType or Error (invalid_argument) for any other state.
Statistics statistics_of(nanobind::handle state);

void bind_pickling(nanobind::module_& module);

}  // namespace crumple::python
