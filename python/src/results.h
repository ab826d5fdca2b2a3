#pragma once

// Results on their way out: Python owns them, and shows their arrays as NumPy's without a copy.

#include <memory>
#include <utility>

#include <nanobind/nanobind.h>

#include "crumple/detector.h"

namespace crumple::python {

/// A result of the library that one of the classes of the same name in Python shows. Its arrays hold it, but not the
/// object of that class, which holds them.
template <class Result>
struct Shown {
    std::shared_ptr<Result> storage;
    const Result& found() const { return *storage; }
};

void bind_results(nanobind::module_& module);

}  // namespace crumple::python
