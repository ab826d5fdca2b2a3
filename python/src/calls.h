#pragma once

// Methods that crumple.Detector calls, one for each query and way of delivery (find, any, stream, ...): _find_impacts,
// _any_impacts and so on.

#include <nanobind/nanobind.h>

#include "detector.h"

namespace crumple::python {

void bind_calls(nanobind::class_<SharedDetector>& detector);

}  // namespace crumple::python
