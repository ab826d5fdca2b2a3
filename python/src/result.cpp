#include "result.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string_view.h>

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// A read-only NumPy view that keeps the storage alive.
template <class Element, class... Shape>
nb::object view(const Result& result, const void* data, Shape... shape) {
    using Owner = std::shared_ptr<Collisions>;
    const nb::capsule capsule(new Owner(result.storage), [](void* p) noexcept { delete static_cast<Owner*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, const Element>(static_cast<const Element*>(data),
                                                          {static_cast<std::size_t>(shape)...}, capsule));
}

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
    nb::class_<S>(module, "Statistics", "What a call did. Times are in milliseconds.")
        .def_ro("milliseconds", &S::milliseconds, "Wall-clock time of the call inside the library.")
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
        .def("__repr__", [](const S& s) {
            return nb::str(
                       "Statistics(milliseconds={:.3f}, triangles={}, box_overlaps={}, exact_tests={}, pairs={}, "
                       "threads={}, backend={!r}, simd={!r})")
                .format(s.milliseconds, s.triangles, s.box_overlaps, s.exact_tests, s.pairs, s.threads, s.backend,
                        s.simd);
        });
}

// crumple.Result, which the package names when it is imported; never released, as types of a module are not.
nb::handle result_class;

// A mesh may hold a result that holds the mesh's arrays.
int visit_meshes(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (!nb::inst_ready(self)) return 0;
    const Result& result = *nb::inst_ptr<Result>(self);
    Py_VISIT(result.first.ptr());
    Py_VISIT(result.second.ptr());
    return 0;
}
int clear_meshes(PyObject* self) {
    if (!nb::inst_ready(self)) return 0;
    Result& result = *nb::inst_ptr<Result>(self);
    result.first.reset();
    result.second.reset();
    return 0;
}
PyType_Slot collected[] = {{Py_tp_traverse, reinterpret_cast<void*>(visit_meshes)},
                           {Py_tp_clear, reinterpret_cast<void*>(clear_meshes)},
                           {0, nullptr}};

}  // namespace

nb::object make_result(Result&& result) {
    nb::object object = nb::inst_alloc(result_class);
    new (nb::inst_ptr<Result>(object)) Result(std::move(result));
    nb::inst_mark_ready(object);
    return object;
}

void bind_result(nb::module_& module) {
    bind_statistics(module);
    nb::class_<Result>(module, "Collisions", nb::type_slots(collected),
                       "The library's answer; crumple.Result gives access to it.")
        .def("__len__", [](const Result& r) { return r.collisions().pairs.size(); })
        .def_prop_ro("_pairs",
                     [](const Result& r) {
                         const auto& pairs = r.collisions().pairs;
                         return view<std::int32_t>(r, pairs.data(), pairs.size(), 2);
                     })
        .def_prop_ro("_offsets",
                     [](const Result& r) {
                         const auto& offsets = r.collisions().offsets;
                         return view<std::int64_t>(r, offsets.data(), offsets.size());
                     })
        .def_prop_ro("_hit",
                     [](const Result& r) {
                         const auto& hit = r.collisions().hit;
                         return view<bool>(r, hit.data(), hit.size());
                     })
        .def_prop_ro("_hit_second",
                     [](const Result& r) {
                         const auto& hit = r.collisions().hit_second;
                         return view<bool>(r, hit.data(), hit.size());
                     })
        .def_prop_ro("_contact_kinds",
                     [](const Result& r) {
                         const auto& kinds = r.collisions().contacts.kinds;
                         return view<std::uint8_t>(r, kinds.data(), kinds.size());
                     })
        .def_prop_ro("_contact_offsets",
                     [](const Result& r) {
                         const auto& offsets = r.collisions().contacts.offsets;
                         return view<std::int64_t>(r, offsets.data(), offsets.size());
                     })
        .def_prop_ro("_contact_points",
                     [](const Result& r) {
                         const auto& points = r.collisions().contacts.points;
                         return view<double>(r, points.data(), points.size(), 3);
                     })
        .def_prop_ro(
            "_statistics", [](const Result& r) -> const Statistics& { return r.collisions().statistics; },
            nb::rv_policy::copy)
        .def_ro("_first", &Result::first)
        .def_ro("_second", &Result::second)
        .def_ro("_has_contacts", &Result::has_contacts)
        .def_ro("_copy", &Result::copy);
    module.def(
        "set_result_class", [](nb::type_object type) { result_class = type.release(); }, "type"_a);
}

}  // namespace crumple::python
