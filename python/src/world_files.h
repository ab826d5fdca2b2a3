#pragma once

// Files of worlds and poses.

#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "crumple/io.h"

namespace crumple::python {

/// Copies a world for the writers of files: its shapes, and the current contents of `poses`. `names`: one per body.
io::WorldMesh copy_of(nanobind::handle world, nanobind::handle poses, const std::vector<std::string>& names);

void bind_world_files(nanobind::module_& module);

}  // namespace crumple::python
