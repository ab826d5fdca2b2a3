#pragma once

// Answers about motion and nearness on their way out: Impacts and Nearby that Python owns, shown as NumPy arrays
// without a copy.

#include <memory>

#include <nanobind/nanobind.h>

#include "crumple/impacts.h"
#include "crumple/proximities.h"

namespace crumple::python {

/// What a crumple.Impacts or crumple.Nearby shows. Its arrays hold it, but not the result, which holds them.
template <class Storage, class Output>
struct FeatureAnswer {
    std::shared_ptr<Storage> storage;
    Output output{};
    bool of_world = false;  ///< else of one mesh, which has no bodies
    bool has_index = false;
    bool has_closest = false, has_least = false;  ///< of nearness
    bool copy = false;                            ///< the result shows writable copies
    bool has_triangle_pairs = false;              ///< of motion
    bool is_block = false;                        ///< which tells of nothing but its rows
    bool of_part = false;                         ///< which knows no edges and points but its own

    const Storage& found() const { return *storage; }
};
using ImpactsAnswer = FeatureAnswer<Impacts, Output>;
using NearbyAnswer = FeatureAnswer<Proximities, Output>;

void bind_feature_answers(nanobind::module_& module);

}  // namespace crumple::python
