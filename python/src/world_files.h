#pragma once

// Files of worlds and poses.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_world_files(nanobind::module_& module);

}  // namespace crumple::python
