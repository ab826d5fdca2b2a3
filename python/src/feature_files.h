#pragma once

// Lists of impacts, of near pairs and of candidates, and meshes that are coloured by them, to files.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_feature_files(nanobind::module_& module);

}  // namespace crumple::python
