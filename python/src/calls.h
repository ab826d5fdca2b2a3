#pragma once

// Calls of a detector, by the name of the query: _find_impacts, _any_impacts and so on, which crumple.Detector.find,
// any and so on call.

#include <nanobind/nanobind.h>

#include "detector.h"

namespace crumple::python {

void bind_calls(nanobind::class_<SharedDetector>& detector);

}  // namespace crumple::python
