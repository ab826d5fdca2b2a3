#pragma once

// Mesh files, lists of pairs and procedural scenes for Python.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_files(nanobind::module_& module);

}  // namespace crumple::python
