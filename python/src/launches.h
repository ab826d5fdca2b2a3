#pragma once

// Questions about meshes in device memory whose answers stay there: Detector.launch_self and its like, and their waits.

#include <nanobind/nanobind.h>

#include "detector.h"

namespace crumple::python {

void bind_launches(nanobind::class_<SharedDetector>& detector);

}  // namespace crumple::python
