#pragma once

// Files of impacts, near pairs and candidates, and of meshes that are coloured by them.

#include <memory>

#include <nanobind/nanobind.h>

#include "crumple/impacts.h"
#include "crumple/proximities.h"

namespace crumple::python {

/// Return the library's result of a crumple.Impacts or crumple.Proximities. For an unpickled object, make a new one,
/// without the members that only an option requests.
/// @{
std::shared_ptr<const Impacts> impacts_of(nanobind::handle result);
std::shared_ptr<const Proximities> proximities_of(nanobind::handle result);
/// @}

void bind_feature_files(nanobind::module_& module);

}  // namespace crumple::python
