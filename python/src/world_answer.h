#pragma once

// The answer for a world on its way out: Intersections that Python owns, shown as NumPy arrays without a copy.

#include <memory>

#include <nanobind/nanobind.h>

#include "crumple/intersections.h"

namespace crumple::python {

/// What a crumple.WorldResult shows. Its arrays hold it, but not the result, which holds them and the world.
struct WorldAnswer {
    std::shared_ptr<Intersections> storage;
    Output output = Output::pairs;
    bool has_index = false;
    bool copy = false;  ///< the result shows writable copies

    const Intersections& collisions() const { return *storage; }
};

void bind_world_answer(nanobind::module_& module);

}  // namespace crumple::python
