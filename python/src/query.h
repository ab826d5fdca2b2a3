#pragma once

// A query as Python gives it.

#include <vector>

#include <nanobind/nanobind.h>

#include "arguments.h"
#include "arrays.h"
#include "names.h"

namespace crumple::python {

/// A query and the pairs that it refers to.
struct OwningQuery {
    OwningQuery(nanobind::handle neighbours, nanobind::handle intersections, nanobind::handle weld,
                nanobind::handle contacts, nanobind::handle wanted, nanobind::handle excluded_groups)
        : excluded(group_pairs(excluded_groups)),
          query{.neighbours = named(neighbours_names, "neighbours", neighbours),
                .intersections = named(intersections_names, "intersections", intersections),
                .weld = flag("weld", weld),
                .contacts = flag("contacts", contacts),
                .wanted = named(wanted_names, "wanted", wanted),
                .excluded_groups = excluded} {}
    OwningQuery(const OwningQuery&) = delete;
    OwningQuery& operator=(const OwningQuery&) = delete;

    const std::vector<GroupPair> excluded;
    const Query query;
};

}  // namespace crumple::python
