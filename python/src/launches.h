#pragma once

// Launches, whose results stay in device memory: _launch_impacts and so on. Each returns a ticket.

#include <nanobind/nanobind.h>

#include "detector.h"

namespace crumple::python {

void bind_launches(nanobind::class_<SharedDetector>& detector);

}  // namespace crumple::python
