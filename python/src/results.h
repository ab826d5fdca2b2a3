#pragma once

// Results for Python, which owns them: arrays as NumPy views.

#include <memory>
#include <utility>

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Result of the library: the storage of the Python class of the same name. NumPy views of its arrays keep this object
/// alive. They do not keep the object of the Python class alive, which caches them; so there is no cycle.
template <class Result>
struct Shown {
    std::shared_ptr<Result> storage;
    const Result& found() const { return *storage; }
};

void bind_results(nanobind::module_& module);

}  // namespace crumple::python
