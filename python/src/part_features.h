#pragma once

// Features of a part as a state for pickle.

#include <nanobind/nanobind.h>

#include "crumple/part.h"

namespace crumple::python {

/// Returns a dict of copied arrays and numbers.
nanobind::dict state_of(const PartFeatures& features);

/// Converts a state. Throws InvalidType for a state that state_of() cannot return. Detector::find refuses inconsistent
/// parts.
PartFeatures features_from(nanobind::handle state);

}  // namespace crumple::python
