#pragma once

// Launches, whose results stay in device memory, and the waits for them: _launch_impacts, _wait_impacts and so on.

#include <nanobind/nanobind.h>

#include "detector.h"

namespace crumple::python {

void bind_launches(nanobind::class_<SharedDetector>& detector);

}  // namespace crumple::python
