#pragma once

// Files of impacts, near pairs and candidates, and of meshes that are coloured by them.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_feature_files(nanobind::module_& module);

}  // namespace crumple::python
