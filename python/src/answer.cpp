#include "answer.h"

#include <cstdint>

#include <nanobind/stl/string_view.h>

#include "pickling.h"
#include "views.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

nb::typed<nb::dict, nb::str, double> stage_milliseconds(const Statistics& statistics) {
    nb::typed<nb::dict, nb::str, double> result;
    for (int i = 0; i < stage_count; ++i) {
        const auto stage = static_cast<Stage>(i);
        const std::string_view name = stage_name(stage);
        result[nb::str(name.data(), name.size())] = statistics[stage];
    }
    return result;
}

void bind_statistics(nb::module_& module) {
    using S = Statistics;
    nb::class_<S> type(
        module, "Statistics",
        "What a call did. Times are in milliseconds. A plain value: equal if all of it is, and it can be\n"
        "copied and pickled.");
    type.attr("__hash__") = nb::none();
    type.def_ro("milliseconds", &S::milliseconds, "Wall-clock time of the call inside the library.")
        .def_prop_ro(
            "stage_milliseconds", stage_milliseconds,
            "Milliseconds by stage, summed over threads: bounds, subdivide, align, sort, sweep, narrow, output.")
        .def_ro("triangles", &S::triangles, "Triangles, of both meshes.")
        .def_ro("clusters", &S::clusters, "Clusters of the first level of subdivision.")
        .def_ro("leaves", &S::leaves, "Clusters that were swept.")
        .def_ro("members", &S::members, "Memberships of triangles in leaves.")
        .def_ro("interval_tests", &S::interval_tests, "Overlaps along the sweep direction.")
        .def_ro("box_overlaps", &S::box_overlaps, "Candidate pairs that left the sweep.")
        .def_ro("edge_tests", &S::edge_tests, "Pairs that no plane separated.")
        .def_ro("double_tests", &S::double_tests, "Pairs that float32 filters left undecided.")
        .def_ro("exact_tests", &S::exact_tests, "Pairs that float64 filters left undecided: exact arithmetic.")
        .def_ro("rational_tests", &S::rational_tests, "Of these, beyond the range of expansions.")
        .def_ro("rational_contacts", &S::rational_contacts, "Contacts that took rational arithmetic.")
        .def_ro("pairs", &S::pairs, "Colliding pairs.")
        .def_ro("peak_memory_bytes", &S::peak_memory_bytes, "Most that the detector has owned, this result included.")
        .def_ro("threads", &S::threads, "Threads of the detector.")
        .def_ro("backend", &S::backend, "\"cpu\", \"cuda\" or \"reference\".")
        .def_ro("simd", &S::simd, "Instruction set that was used; empty for the reference backend.")
        .def("__repr__",
             [](const S& s) {
                 return nb::str(
                            "Statistics(milliseconds={:.3f}, triangles={}, box_overlaps={}, exact_tests={}, pairs={}, "
                            "threads={}, backend={!r}, simd={!r})")
                     .format(s.milliseconds, s.triangles, s.box_overlaps, s.exact_tests, s.pairs, s.threads, s.backend,
                             s.simd);
             })
        .def(
            "__eq__",
            [](const S& s, nb::handle other) -> nb::object {
                if (!nb::isinstance<S>(other) || !nb::inst_ready(other)) return nb::borrow(Py_NotImplemented);
                return nb::bool_(state_of(s).equal(state_of(*nb::inst_ptr<S>(other))));
            },
            "other"_a.none())
        .def("__getstate__", [](const S& s) { return state_of(s); })
        .def(
            "__setstate__", [](S& s, nb::handle state) { new (&s) S(statistics_of(state)); }, "state"_a.none());
}

}  // namespace

void bind_answer(nb::module_& module) {
    bind_statistics(module);
    constexpr auto owner = nb::rv_policy::reference_internal;
    nb::class_<Answer>(module, "Answer", "The library's answer to a call; crumple.Result gives access to it.")
        .def("__len__", [](const Answer& a) { return a.collisions().pairs.size(); })
        .def("deep_copy",
             [](const Answer& a) {
                 return Answer{std::make_shared<Intersections>(a.collisions()), a.has_contacts, a.copy};
             })
        .def_prop_ro(
            "pairs", [](const Answer& a) { return view<std::int32_t>(a.collisions().pairs, 2U); }, owner)
        .def_prop_ro(
            "offsets", [](const Answer& a) { return view<std::int64_t>(a.collisions().offsets); }, owner)
        .def_prop_ro(
            "hit", [](const Answer& a) { return view<bool>(a.collisions().hit); }, owner)
        .def_prop_ro(
            "hit_second", [](const Answer& a) { return view<bool>(a.collisions().hit_second); }, owner)
        .def_prop_ro(
            "contact_kinds", [](const Answer& a) { return view<std::uint8_t>(a.collisions().contacts.kinds); }, owner)
        .def_prop_ro(
            "contact_offsets", [](const Answer& a) { return view<std::int64_t>(a.collisions().contacts.offsets); },
            owner)
        .def_prop_ro(
            "contact_points", [](const Answer& a) { return view<double>(a.collisions().contacts.points, 3U); }, owner)
        .def_prop_ro("statistics", [](const Answer& a) { return Statistics(a.collisions().statistics); })
        .def_ro("has_contacts", &Answer::has_contacts)
        .def_ro("copy", &Answer::copy);
}

}  // namespace crumple::python
