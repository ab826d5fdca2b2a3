#pragma once

// What a part knows of vertices and edges, as Python sees it and as pickle keeps it.

#include <nanobind/nanobind.h>

#include "crumple/part.h"

namespace crumple::python {

/// A dict of arrays and numbers that share nothing with the part.
nanobind::dict state_of(const PartFeatures& features);

/// Throws InvalidType for what state_of() cannot have made. What does not fit together is refused where the part is
/// asked.
PartFeatures features_from(nanobind::handle state);

}  // namespace crumple::python
