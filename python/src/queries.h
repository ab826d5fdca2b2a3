#pragma once

// Conversion of the dataclasses of crumple/_queries.py to queries of the library.

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Converts a query by the names of its attributes. Throws Error for wrong types and unknown names. Caches a query of
/// constant members in `given`, which halves the cost of a small call.
template <class Query>
Query read(nanobind::handle given);

}  // namespace crumple::python
