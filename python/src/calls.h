#pragma once

// Calls of a detector, one for each query and delivery: _find_impacts, _any_impacts and so on, for crumple.Detector.

#include <nanobind/nanobind.h>

#include "detector.h"

namespace crumple::python {

void bind_calls(nanobind::class_<SharedDetector>& detector);

}  // namespace crumple::python
