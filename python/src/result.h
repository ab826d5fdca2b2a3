#pragma once

// The answer on its way out: a Collisions that Python owns, shown as NumPy arrays without a copy.

#include <memory>
#include <optional>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/collisions.h"

namespace crumple::python {

/// What lies in a crumple.Result. Its base class is made without nanobind, which keeps a table of all its instances:
/// thirty lines of code more to fetch into the caches that a search has swept. Arrays own the storage and not the
/// result, which keeps them.
struct Result {
    std::shared_ptr<Collisions> storage;
    GivenMesh first;
    std::optional<GivenMesh> second;  ///< none for one soup
    bool has_contacts = false, copy = false;

    const Collisions& collisions() const { return *storage; }
};

/// A new crumple.Result.
nanobind::object make_result(Result&& result);

/// What lies in a crumple.Result.
const Result& result_of(nanobind::handle object);

void bind_result(nanobind::module_& module);

}  // namespace crumple::python
