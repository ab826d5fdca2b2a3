#pragma once

// Conversion of the features of a crumple.Part to a state for pickle, and back.

#include <nanobind/nanobind.h>

#include "crumple/part.h"

namespace crumple::python {

/// Returns a dict of all members by name: copies of arrays, and numbers.
nanobind::dict state_of(const PartFeatures& features);

/// Converts a state that state_of() returned. Throws InvalidType if members are missing or of another type. Consistency
/// is checked later, by Detector::find.
PartFeatures features_from(nanobind::handle state);

}  // namespace crumple::python
