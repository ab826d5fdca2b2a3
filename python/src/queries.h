#pragma once

// Conversion of the dataclasses of crumple/_queries.py to queries of the library.

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Converts a Python query: reads its attributes by name. Throws Error if an attribute has a wrong type or value. If
/// all attributes are constants, caches the result in `given`, which halves the cost of a small call.
template <class Query>
Query read(nanobind::handle given);

}  // namespace crumple::python
