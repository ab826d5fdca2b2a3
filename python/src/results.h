#pragma once

// Results for Python, which owns them: arrays as NumPy views.

#include <memory>
#include <utility>

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// Result of the library, storage of the class of the same name in Python. Its arrays keep this object alive, but not
/// the object of that class, which caches them.
template <class Result>
struct Shown {
    std::shared_ptr<Result> storage;
    const Result& found() const { return *storage; }
};

void bind_results(nanobind::module_& module);

}  // namespace crumple::python
