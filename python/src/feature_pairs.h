#pragma once

// Decisions about pairs of features that the caller provides, and rigid motions: crumple/_feature_pairs.py and
// crumple/_rigid_motion.py are the public modules.

#include <nanobind/nanobind.h>

namespace crumple::python {

void bind_feature_pairs(nanobind::module_& module);

}  // namespace crumple::python
