#pragma once

// The answer on its way out: Intersections that Python owns, shown as NumPy arrays without a copy.

#include <memory>

#include <nanobind/nanobind.h>

#include "crumple/intersections.h"

namespace crumple::python {

/// What a crumple.Result shows. Its arrays hold it, but not the result, which holds them and the meshes.
struct Answer {
    std::shared_ptr<Intersections> storage;
    bool has_contacts = false;
    bool copy = false;  ///< the result shows writable copies

    const Intersections& collisions() const { return *storage; }
};

void bind_answer(nanobind::module_& module);

}  // namespace crumple::python
