#include "queries.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <typeinfo>

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

// Converts a filter, except its excluded bodies: these may be names, whose indices depend on the scene (excluded_in()).
PairFilter filter_of(nb::handle query) {
    const nb::object given = query.attr("filter");
    return {.bodies = named(scope_names, "bodies", given.attr("bodies")),
            .groups = named(scope_names, "groups", given.attr("groups")),
            .excluded_groups = group_pairs(given.attr("excluded_groups"))};
}

// Reads a tuple of tuples of three numbers.
std::vector<std::array<double, 3>> vectors(const char* name, nb::handle given) {
    std::vector<std::array<double, 3>> all;
    for (nb::handle row : nb::cast<nb::tuple>(given)) {
        const auto vector = nb::cast<nb::tuple>(row);
        for (std::size_t k = 0; k < 3; ++k) (k == 0 ? all.emplace_back() : all.back())[k] = real(name, vector[k]);
    }
    return all;
}

// Reads the members that ImpactQuery, FirstImpactQuery and FreeStepQuery have in common.
void read_step(nb::handle given, ImpactQuery& query) {
    query.min_distance = real_of(given, "min_distance");
    query.min_distance_share = real_of(given, "min_distance_share");
    query.approaching_only = flag_of(given, "approaching_only");
    query.weld = flag_of(given, "weld");
    query.filter = filter_of(given);
}

void read(nb::handle given, IntersectionQuery& query) {
    query.output = output_of(given, intersection_output_names);
    query.neighbours = named(neighbours_names, "neighbours", given.attr("neighbours"));
    query.kind = named(intersection_kind_names, "kind", given.attr("kind"));
    query.weld = flag_of(given, "weld");
    query.containment = flag_of(given, "containment");
    query.open = named(open_surfaces_names, "open", given.attr("open"));
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
    query.held = named(held_names, "held", given.attr("held"));
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
    query.neighbours = flag_of(given, "neighbours");
    query.filter = filter_of(given);
}

void read(nb::handle given, DistanceQuery& query) {
    query.output = output_of(given, distance_output_names);
    query.radius = real_of(given, "radius");
    query.filter = filter_of(given);
}

void read(nb::handle given, OverlapQuery& query) {
    query.output = output_of(given, overlap_output_names);
    query.min_volume = real_of(given, "min_volume");
    query.open = named(open_surfaces_names, "open", given.attr("open"));
    query.weld = flag_of(given, "weld");
    query.self_overlaps = flag_of(given, "self_overlaps");
    query.gradient = flag_of(given, "gradient");
    query.curves = flag_of(given, "curves");
    query.windings = flag_of(given, "windings");
    query.depths = flag_of(given, "depths");
    query.depth_tolerance = real_of(given, "depth_tolerance");
    query.directions = vectors("directions", given.attr("directions"));
    query.first_free = flag_of(given, "first_free");
    query.translation = flag_of(given, "translation");
    query.solids = flag_of(given, "solids");
    query.extents = flag_of(given, "extents");
    query.unions = flag_of(given, "unions");
    query.regions = flag_of(given, "regions");
    query.filter = filter_of(given);
}

bool is_constant(nb::handle value);

// True if the values of all members of a dataclass but `filter` are constants. Attributes with a leading underscore are
// not members.
bool is_frozen(nb::handle object) {
    for (const auto [name, value] : nb::cast<nb::dict>(object.attr("__dict__")))
        if (const std::string_view member = text("member", name);
            !member.starts_with('_') && member != "filter" && !is_constant(value))
            return false;
    return true;
}

bool is_constant(nb::handle value) {
    PyObject* const v = value.ptr();
    if (PyTuple_CheckExact(v)) return std::ranges::all_of(nb::borrow<nb::tuple>(value), is_constant);
    if (PyFrozenSet_CheckExact(v)) return std::ranges::all_of(nb::tuple(value), is_constant);
    return value.is_none() || PyBool_Check(v) || PyUnicode_CheckExact(v) || PyLong_CheckExact(v) ||
           PyFloat_CheckExact(v);
}

// Returns the query that keep() has cached, or null. Every query class has the attribute `_read`, initially None.
template <class Query>
const Query* kept(nb::handle given) {
    const nb::object capsule = given.attr("_read");
    return static_cast<const Query*>(PyCapsule_IsValid(capsule.ptr(), typeid(Query).name())
                                         ? PyCapsule_GetPointer(capsule.ptr(), typeid(Query).name())
                                         : nullptr);
}

// Caches the query in the Python object that it was read from.
template <class Query>
void keep(nb::handle given, const Query& query) {
    const nb::capsule capsule(new Query(query), typeid(Query).name(),
                              [](void* p) noexcept { delete static_cast<Query*>(p); });
    if (PyObject_GenericSetAttr(given.ptr(), nb::str("_read").ptr(), capsule.ptr())) throw nb::python_error();
}

}  // namespace

template <class Query>
Query read(nb::handle given) {
    if (const Query* const known = kept<Query>(given)) return *known;
    Query query;
    read(given, query);
    if (is_frozen(given) && is_frozen(given.attr("filter"))) keep(given, query);
    return query;
}

template IntersectionQuery read(nb::handle);
template ImpactQuery read(nb::handle);
template FirstImpactQuery read(nb::handle);
template FreeStepQuery read(nb::handle);
template ProximityQuery read(nb::handle);
template CandidateQuery read(nb::handle);
template DistanceQuery read(nb::handle);
template OverlapQuery read(nb::handle);

}  // namespace crumple::python
