#pragma once

// Methods of a detector that launch a search on the device, whose result stays in device memory: _launch_impacts and so
// on. Each returns a ticket, with which the caller waits for the result.

#include <nanobind/nanobind.h>

#include "detector.h"

namespace crumple::python {

void bind_launches(nanobind::class_<SharedDetector>& detector);

}  // namespace crumple::python
