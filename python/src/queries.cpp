#include "queries.h"

#include <cstdint>
#include <string>

#include "arguments.h"
#include "arrays.h"
#include "names.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

template <std::size_t count>
Output output_of(nb::handle query, const Names<Output, count>& names) {
    return named(names, "output", query.attr("output"));
}

bool flag_of(nb::handle query, const char* name) { return flag(name, query.attr(name)); }
double real_of(nb::handle query, const char* name) { return real(name, query.attr(name)); }

// Without excluded bodies, whose names only the scene knows.
PairFilter filter_of(nb::handle query) {
    const nb::object given = query.attr("filter");
    return {.bodies = named(scope_names, "bodies", given.attr("bodies")),
            .groups = named(scope_names, "groups", given.attr("groups")),
            .excluded_groups = group_pairs(given.attr("excluded_groups"))};
}

// Members that all queries about a step have.
void read_step(nb::handle given, ImpactQuery& query) {
    query.min_distance = real_of(given, "min_distance");
    query.min_distance_share = real_of(given, "min_distance_share");
    query.weld = flag_of(given, "weld");
    query.filter = filter_of(given);
}

}  // namespace

void read(nb::handle given, IntersectionQuery& query) {
    query.output = output_of(given, intersection_output_names);
    query.neighbours = named(neighbours_names, "neighbours", given.attr("neighbours"));
    query.kind = named(intersection_kind_names, "kind", given.attr("kind"));
    query.weld = flag_of(given, "weld");
    query.filter = filter_of(given);
    query.index = flag_of(given, "index");
}

void read(nb::handle given, ImpactQuery& query) {
    read_step(given, query);
    query.output = output_of(given, impact_output_names);
    query.index = flag_of(given, "index");
    query.triangle_pairs = flag_of(given, "triangle_pairs");
}

void read(nb::handle given, FirstImpactQuery& query) { read_step(given, query); }

void read(nb::handle given, FreeStepQuery& query) {
    read_step(given, query);
    query.triangle_pairs = flag_of(given, "triangle_pairs");
}

void read(nb::handle given, ProximityQuery& query) {
    query.output = output_of(given, proximity_output_names);
    const nb::object radius = given.attr("radius");
    if (!radius.is_none()) query.radius = real("radius", radius);
    query.strict = flag_of(given, "strict");
    query.closest = flag_of(given, "closest");
    query.least = flag_of(given, "least");
    query.weld = flag_of(given, "weld");
    query.rings = integer<std::int32_t>("rings", given.attr("rings"));
    query.rest_radius = real_of(given, "rest_radius");
    query.filter = filter_of(given);
    query.index = flag_of(given, "index");
}

void read(nb::handle given, CandidateQuery& query) {
    query.kinds.clear();
    for (const nb::handle kind : given.attr("kinds")) query.kinds.push_back(named(candidate_kind_names, "kinds", kind));
    query.inflation = real_of(given, "inflation");
    query.weld = flag_of(given, "weld");
    query.filter = filter_of(given);
}

void read(nb::handle given, DistanceQuery& query) {
    query.radius = real_of(given, "radius");
    query.filter = filter_of(given);
}

}  // namespace crumple::python
