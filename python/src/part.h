#pragma once

// crumple.Part, the part of a scene that one of several machines searches.

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Returns the Part of a Python object.
const Part& given_part(nanobind::handle part);

void bind_part(nanobind::module_& module);

}  // namespace crumple::python
