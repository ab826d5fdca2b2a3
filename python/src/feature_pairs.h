#pragma once

// Pairs of features that the caller brings, decided: crumple/_feature_pairs.py has what people see.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_feature_pairs(nanobind::module_& module);

}  // namespace crumple::python
