#pragma once

// Distances of bodies: what is asked, the call that answers it, and the answer as NumPy arrays without a copy.

#include <memory>

#include <nanobind/nanobind.h>

#include "crumple/distances.h"

namespace crumple::python {

/// Storage behind a crumple.NearestBodies. Its arrays hold it, but not the result, which holds them.
struct NearestAnswer {
    std::shared_ptr<Distances> storage;
    bool copy = false;  ///< the result shows writable copies

    const Distances& found() const { return *storage; }
};

NearestAnswer find_nearest(nanobind::handle self, nanobind::handle world, nanobind::handle poses,
                           const DistanceQuery& question, nanobind::handle excluded, nanobind::handle copy);

void bind_nearest(nanobind::module_& module);

}  // namespace crumple::python
