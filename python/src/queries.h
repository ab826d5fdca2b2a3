#pragma once

// Queries on their way in: the dataclasses of crumple/_queries.py as those of the library.

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Makes a query of the attributes of the same names. Throws where one is of another type or has another name. A query
/// of words and numbers is kept, read, in `given`, which halves the cost of a small call.
template <class Query>
Query read(nanobind::handle given);

}  // namespace crumple::python
