#include "result.h"

#include <exception>
#include <utility>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string_view.h>

#include "arguments.h"
#include "errors.h"
#include "gil.h"
#include "pickling.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// A read-only NumPy view of an array, with as many columns as its elements have; it keeps the storage alive.
template <class Number, class Element, class... Columns>
nb::object view(const Result& result, const Array<Element>& array, Columns... columns) {
    using Owner = std::shared_ptr<Collisions>;
    import_numpy();
    const nb::capsule capsule(new Owner(result.storage), [](void* p) noexcept { delete static_cast<Owner*>(p); });
    const void* const data = array.data();
    return nb::cast(nb::ndarray<nb::numpy, const Number>(static_cast<const Number*>(data),
                                                         {array.size(), std::size_t{columns}...}, capsule));
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

// crumple.Result, which the package names when it is imported; never released, as types of a module are not.
nb::handle result_class;

struct Object {
    PyObject_HEAD;
    Result result;
};
Result& in(PyObject* self) { return reinterpret_cast<Object*>(self)->result; }

// A mesh may hold a result that holds the mesh's arrays.
int visit_mesh(const GivenMesh& mesh, visitproc visit, void* arg) {
    Py_VISIT(mesh.vertices.ptr());
    Py_VISIT(mesh.faces.ptr());
    Py_VISIT(mesh.groups.ptr());
    return 0;
}
int visit_meshes(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    const Result& result = in(self);
    const int stop = visit_mesh(result.first, visit, arg);
    return stop || !result.second ? stop : visit_mesh(*result.second, visit, arg);
}
int clear_meshes(PyObject* self) {
    in(self).first = {nb::none(), nb::none(), nb::none()};
    in(self).second.reset();
    return 0;
}
void drop_result(PyObject* self) {
    PyObject_GC_UnTrack(self);
    const nb::object type = nb::steal(reinterpret_cast<PyObject*>(Py_TYPE(self)));
    in(self).~Result();
    PyObject_GC_Del(self);
}

Py_ssize_t length(PyObject* self) { return static_cast<Py_ssize_t>(in(self).collisions().pairs.size()); }

nb::object tuple_of(const GivenMesh& mesh) { return nb::make_tuple(mesh.vertices, mesh.faces, mesh.groups); }

nb::object pairs(const Result& r) { return view<std::int32_t>(r, r.collisions().pairs, 2U); }
nb::object offsets(const Result& r) { return view<std::int64_t>(r, r.collisions().offsets); }
nb::object hit(const Result& r) { return view<bool>(r, r.collisions().hit); }
nb::object hit_second(const Result& r) { return view<bool>(r, r.collisions().hit_second); }
nb::object contact_kinds(const Result& r) { return view<std::uint8_t>(r, r.collisions().contacts.kinds); }
nb::object contact_offsets(const Result& r) { return view<std::int64_t>(r, r.collisions().contacts.offsets); }
nb::object contact_points(const Result& r) { return view<double>(r, r.collisions().contacts.points, 3U); }
nb::object statistics(const Result& r) { return nb::cast(r.collisions().statistics, nb::rv_policy::copy); }
nb::object first(const Result& r) { return tuple_of(r.first); }
nb::object second(const Result& r) { return r.second ? tuple_of(*r.second) : nb::none(); }
nb::object has_contacts(const Result& r) { return nb::bool_(r.has_contacts); }
nb::object copy(const Result& r) { return nb::bool_(r.copy); }

template <nb::object (*read)(const Result&)>
PyObject* get(PyObject* self, void* /*closure*/) noexcept {
    try {
        return read(in(self)).release().ptr();
    } catch (...) {
        raise_in_python(std::current_exception());
        return nullptr;
    }
}

template <nb::object (*read)(const Result&)>
constexpr PyGetSetDef property(const char* name) {
    return {name, get<read>, nullptr, nullptr, nullptr};
}

PyGetSetDef result_properties[] = {property<pairs>("_pairs"),
                                   property<offsets>("_offsets"),
                                   property<hit>("_hit"),
                                   property<hit_second>("_hit_second"),
                                   property<contact_kinds>("_contact_kinds"),
                                   property<contact_offsets>("_contact_offsets"),
                                   property<contact_points>("_contact_points"),
                                   property<statistics>("_statistics"),
                                   property<first>("_first"),
                                   property<second>("_second"),
                                   property<has_contacts>("_has_contacts"),
                                   property<copy>("_copy"),
                                   {nullptr, nullptr, nullptr, nullptr, nullptr}};
PyType_Slot result_slots[] = {
    {Py_tp_doc, const_cast<char*>("The library's answer; crumple.Result gives access to it.")},
    {Py_tp_getset, result_properties},
    {Py_sq_length, reinterpret_cast<void*>(length)},
    {Py_tp_traverse, reinterpret_cast<void*>(visit_meshes)},
    {Py_tp_clear, reinterpret_cast<void*>(clear_meshes)},
    {Py_tp_dealloc, reinterpret_cast<void*>(drop_result)},
    {0, nullptr}};
PyType_Spec result_spec{
    "crumple._core.Collisions", sizeof(Object), 0,
    Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_DISALLOW_INSTANTIATION, result_slots};
PyObject* base_class = nullptr;

}  // namespace

nb::object make_result(Result&& result) {
    const auto type = reinterpret_cast<PyTypeObject*>(result_class.ptr());
    PyObject* const object = in_python([&] { return PyType_GenericAlloc(type, 0); });
    if (!object) throw nb::python_error();
    new (&in(object)) Result(std::move(result));
    return nb::steal(object);
}

const Result& result_of(nb::handle object) {
    if (!PyObject_TypeCheck(object.ptr(), reinterpret_cast<PyTypeObject*>(base_class)))
        refuse_type("result", "a crumple.Result", object);
    return in(object.ptr());
}

void bind_result(nb::module_& module) {
    bind_statistics(module);
    base_class = PyType_FromSpec(&result_spec);
    if (!base_class) throw nb::python_error();
    module.attr("Collisions") = nb::handle(base_class);
    module.def(
        "set_result_class", [](nb::type_object type) { result_class = type.release(); }, "type"_a);
}

}  // namespace crumple::python
