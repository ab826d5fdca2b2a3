#pragma once

// Options of a detector from Python.

#include <nanobind/nanobind.h>

#include "crumple/options.h"

namespace crumple::python {

/// Converts a dict that has a value for every option, by its name.
Options options_of(const nanobind::dict& given);

}  // namespace crumple::python
