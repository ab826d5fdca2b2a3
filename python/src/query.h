#pragma once

// A query about the triangles of meshes, as Python gives it.

#include <nanobind/nanobind.h>

#include "arguments.h"
#include "arrays.h"
#include "crumple/intersections.h"
#include "names.h"

namespace crumple::python {

inline IntersectionQuery make_query(nanobind::handle neighbours, nanobind::handle intersections, nanobind::handle weld,
                                    nanobind::handle contacts, nanobind::handle wanted,
                                    nanobind::handle excluded_groups) {
    IntersectionQuery query;
    query.filter.excluded_groups = group_pairs(excluded_groups);
    query.neighbours = named(neighbours_names, "neighbours", neighbours);
    query.kind = named(intersections_names, "intersections", intersections);
    query.weld = flag("weld", weld);
    query.output = flag("contacts", contacts) ? Output::contacts : Output::pairs;
    query.filter.groups = named(wanted_names, "wanted", wanted);
    return query;
}

}  // namespace crumple::python
