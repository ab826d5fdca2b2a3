#pragma once

// Options of a detector from Python.

#include <nanobind/nanobind.h>

#include "crumple/options.h"

namespace crumple::python {

/// Converts a dict of all options, by name.
Options options_of(const nanobind::dict& given);

}  // namespace crumple::python
