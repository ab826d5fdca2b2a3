#pragma once

// A detector's options as Python gives them.

#include <nanobind/nanobind.h>

#include "crumple/options.h"

namespace crumple::python {

/// Of a dict that has all of them, by their names.
Options options_of(const nanobind::dict& given);

}  // namespace crumple::python
