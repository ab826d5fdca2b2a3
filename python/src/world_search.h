#pragma once

// What is asked about a world, and the call that answers it.

#include <nanobind/nanobind.h>

#include "crumple/world.h"
#include "world.h"
#include "world_answer.h"

namespace crumple::python {

class SharedDetector;

/// The bodies where they are, by the detector's own array, which it is the turn of, where poses lie on the host.
World posed_world(const Bodies& bodies, const BorrowedPoses& poses, SharedDetector& detector);

WorldAnswer find_world(nanobind::handle self, nanobind::handle world, nanobind::handle poses,
                       const IntersectionQuery& question, nanobind::handle excluded, nanobind::handle copy);

void bind_question(nanobind::module_& module);

}  // namespace crumple::python
