#pragma once

// crumple.Part: one of the parts that a scene is divided into, so that several machines can search a part each.

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Returns the Part of a Python object.
const Part& given_part(nanobind::handle part);

void bind_part(nanobind::module_& module);

}  // namespace crumple::python
