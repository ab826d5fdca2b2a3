#pragma once

// crumple.check: verdicts on bodies of files, meshes and worlds.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_checks(nanobind::module_& module);

}  // namespace crumple::python
