#pragma once

// Stencils of near pairs and impacts: crumple/_stencils.py is the public module.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_stencils(nanobind::module_& module);

}  // namespace crumple::python
