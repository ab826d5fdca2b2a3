#pragma once

// crumple.Part, what one of several machines answers of a scene.

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// The Part in an object.
const Part& given_part(nanobind::handle part);

void bind_part(nanobind::module_& module);

}  // namespace crumple::python
