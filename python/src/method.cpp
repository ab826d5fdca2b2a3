#include "method.h"

#include <utility>
#include <vector>

#include <structmember.h>

#include "gil.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

struct Method {
    PyObject_HEAD;
    Call call;
    PyObject* declaration;
    PyObject* parameters;  // the names, a tuple of interned str
    Py_ssize_t positional, required;
};

const Method& method_of(PyObject* self) { return *reinterpret_cast<const Method*>(self); }

int visit_method(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    Py_VISIT(method_of(self).declaration);
    return 0;
}

// Somebody's __del__ may yet call it.
int clear_method(PyObject* self) {
    const nb::object old = nb::steal(std::exchange(reinterpret_cast<Method*>(self)->declaration, Py_NewRef(Py_None)));
    return 0;
}

void drop_method(PyObject* self) {
    PyObject_GC_UnTrack(self);
    const nb::object declaration = nb::steal(method_of(self).declaration);
    const nb::object parameters = nb::steal(method_of(self).parameters);
    const nb::object type = nb::steal(reinterpret_cast<PyObject*>(Py_TYPE(self)));
    PyObject_GC_Del(self);
}

// detector.find_self where it is not called at once: a bound method.
PyObject* bind_self(PyObject* self, PyObject* detector, PyObject* /*type*/) {
    if (!detector || detector == Py_None) return Py_NewRef(self);
    try {
        return nb::module_::import_("types").attr("MethodType")(nb::handle(self), nb::handle(detector)).release().ptr();
    } catch (nb::python_error& error) {
        error.restore();
        return nullptr;
    }
}

// Whatever else is asked of the method is asked of its declaration: name, documentation, annotations, source.
PyObject* attribute(PyObject* self, PyObject* name) {
    PyObject* const declaration = method_of(self).declaration;
    if (PyUnicode_CompareWithASCIIString(name, "__wrapped__") == 0) return Py_NewRef(declaration);
    for (const char* const of_the_type : {"__doc__", "__module__"})
        if (PyUnicode_CompareWithASCIIString(name, of_the_type) == 0) return PyObject_GetAttr(declaration, name);
    PyObject* const own = PyObject_GenericGetAttr(self, name);
    if (own || !PyErr_ExceptionMatches(PyExc_AttributeError)) return own;
    PyErr_Clear();
    return PyObject_GetAttr(declaration, name);
}

PyObject* represent(PyObject* self) { return PyObject_Repr(method_of(self).declaration); }

PyMemberDef method_members[] = {{"__vectorcalloffset__", T_PYSSIZET, offsetof(Method, call), READONLY, nullptr},
                                {nullptr, 0, 0, 0, nullptr}};
PyType_Slot method_slots[] = {{Py_tp_call, reinterpret_cast<void*>(PyVectorcall_Call)},
                              {Py_tp_descr_get, reinterpret_cast<void*>(bind_self)},
                              {Py_tp_repr, reinterpret_cast<void*>(represent)},
                              {Py_tp_getattro, reinterpret_cast<void*>(attribute)},
                              {Py_tp_members, method_members},
                              {Py_tp_traverse, reinterpret_cast<void*>(visit_method)},
                              {Py_tp_clear, reinterpret_cast<void*>(clear_method)},
                              {Py_tp_dealloc, reinterpret_cast<void*>(drop_method)},
                              {0, nullptr}};
PyType_Spec method_spec{"crumple._core.Method", sizeof(Method), 0,
                        Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_HAVE_VECTORCALL |
                            Py_TPFLAGS_METHOD_DESCRIPTOR | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                        method_slots};

// Which parameter has this name; -1: none. Names are interned as a rule, those of f(**json.loads(...)) are not.
Py_ssize_t index_of(PyObject* name, PyObject* parameters) {
    const Py_ssize_t count = PyTuple_Size(parameters);
    for (Py_ssize_t i = 0; i < count; ++i)
        if (PyTuple_GetItem(parameters, i) == name) return i;
    for (Py_ssize_t i = 0; i < count; ++i)
        if (PyUnicode_Compare(PyTuple_GetItem(parameters, i), name) == 0) return i;
    return -1;
}

}  // namespace

bool bind_arguments(PyObject* self, PyObject* const* arguments, std::size_t flags, PyObject* keywords,
                    std::span<nb::handle> given) {
    const Method& method = method_of(self);
    const Py_ssize_t positional = PyVectorcall_NARGS(flags);
    if (positional > method.positional) return false;
    for (Py_ssize_t i = 0; i < positional; ++i) given[static_cast<std::size_t>(i)] = arguments[i];
    const Py_ssize_t named = keywords ? PyTuple_Size(keywords) : 0;
    for (Py_ssize_t i = 0; i < named; ++i) {
        const Py_ssize_t which = index_of(PyTuple_GetItem(keywords, i), method.parameters);
        if (which < 0 || given[static_cast<std::size_t>(which)].is_valid()) return false;
        given[static_cast<std::size_t>(which)] = arguments[positional + i];
    }
    for (Py_ssize_t i = 0; i < method.required; ++i)
        if (!given[static_cast<std::size_t>(i)].is_valid()) return false;
    return true;
}

PyObject* refuse_arguments(PyObject* self, PyObject* const* arguments, std::size_t flags, PyObject* keywords) {
    const nb::object names = nb::steal(in_python([] { return PyImport_ImportModule("crumple._names"); }));
    const nb::object refuse = names ? nb::steal(PyObject_GetAttrString(names.ptr(), "refuse")) : nb::object();
    if (!refuse) return nullptr;
    const Py_ssize_t positional = PyVectorcall_NARGS(flags);
    const Py_ssize_t count = positional + (keywords ? PyTuple_Size(keywords) : 0);
    std::vector<PyObject*> given{method_of(self).declaration};
    given.insert(given.end(), arguments, arguments + count);
    const auto before_keywords = static_cast<std::size_t>(positional) + 1;
    return in_python([&] { return PyObject_Vectorcall(refuse.ptr(), given.data(), before_keywords, keywords); });
}

nb::object make_method(nb::handle declaration, std::span<const char* const> parameters, Call call) {
    const nb::object code = declaration.attr("__code__");
    const auto positional = nb::cast<std::size_t>(code.attr("co_argcount"));
    const std::size_t count = positional + nb::cast<std::size_t>(code.attr("co_kwonlyargcount"));
    const nb::object names = code.attr("co_varnames")[nb::slice(count)];
    bool as_defined = count == parameters.size();
    for (std::size_t i = 0; as_defined && i < count; ++i) as_defined = names[i].equal(nb::str(parameters[i]));
    if (!as_defined) refuse("a method is declared with other parameters than it is defined with");
    const nb::object defaults = declaration.attr("__defaults__");
    static PyObject* const type = PyType_FromSpec(&method_spec);
    if (!type) throw nb::python_error();
    Method* const method = PyObject_GC_New(Method, reinterpret_cast<PyTypeObject*>(type));
    if (!method) throw nb::python_error();
    method->call = call;
    method->declaration = nb::borrow(declaration).release().ptr();
    method->parameters = nb::object(names).release().ptr();
    method->positional = static_cast<Py_ssize_t>(positional);
    method->required = static_cast<Py_ssize_t>(positional - (defaults.is_none() ? 0 : nb::len(defaults)));
    PyObject_GC_Track(method);
    return nb::steal(reinterpret_cast<PyObject*>(method));
}

}  // namespace crumple::python
