#include "world_answer.h"

#include <cstdint>

#include <nanobind/stl/string_view.h>

#include "names.h"
#include "views.h"

namespace nb = nanobind;

namespace crumple::python {

void bind_world_answer(nb::module_& module) {
    constexpr auto owner = nb::rv_policy::reference_internal;
    using A = WorldAnswer;
    nb::class_<A>(module, "WorldAnswer",
                  "The library's answer to a call on a world; crumple.WorldResult gives access to it.")
        .def_prop_ro("any", [](const A& a) { return a.collisions().any; })
        .def_prop_ro("count", [](const A& a) { return a.collisions().count; })
        .def_prop_ro(
            "world_hit", [](const A& a) { return view<bool>(a.collisions().world_hit); }, owner)
        .def_prop_ro(
            "world_counts", [](const A& a) { return view<std::int64_t>(a.collisions().world_counts); }, owner)
        .def_prop_ro(
            "bodies", [](const A& a) { return view<std::int32_t>(a.collisions().bodies, 2U); }, owner)
        .def_prop_ro(
            "pairs", [](const A& a) { return view<std::int32_t>(a.collisions().pairs, 2U); }, owner)
        .def_prop_ro(
            "contact_kinds", [](const A& a) { return view<std::uint8_t>(a.collisions().contacts.kinds); }, owner)
        .def_prop_ro(
            "contact_offsets", [](const A& a) { return view<std::int64_t>(a.collisions().contacts.offsets); }, owner)
        .def_prop_ro(
            "contact_points", [](const A& a) { return view<double>(a.collisions().contacts.points, 3U); }, owner)
        .def_prop_ro(
            "world_offsets", [](const A& a) { return view<std::int64_t>(a.collisions().world_offsets); }, owner)
        .def_prop_ro(
            "body_offsets", [](const A& a) { return view<std::int64_t>(a.collisions().body_offsets); }, owner)
        .def_prop_ro(
            "first_triangle", [](const A& a) { return view<std::int64_t>(a.collisions().first_triangle); }, owner)
        .def_prop_ro(
            "hit", [](const A& a) { return view<bool>(a.collisions().hit); }, owner)
        .def_prop_ro("statistics", [](const A& a) { return Statistics(a.collisions().statistics); })
        .def_prop_ro("wants", [](const A& a) { return name_of(wants_names, a.output); })
        .def_ro("has_index", &A::has_index)
        .def_ro("copy", &A::copy);
}

}  // namespace crumple::python
