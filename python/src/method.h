#pragma once

// Methods that crumple/_detector.py declares, with signature, types and documentation, and that C++ defines.
//
// A search sweeps the caches, so that whatever runs around it comes from memory, line by line. So there are few lines:
// no frame of Python, no overloads, and what is not given is neither passed nor read.

#include <array>
#include <cstddef>
#include <exception>
#include <span>

#include <nanobind/nanobind.h>

#include "errors.h"
#include "gil.h"

namespace crumple::python {

/// What a call gives for each parameter, self first; null where it gives nothing.
template <std::size_t count>
using Given = std::array<nanobind::handle, count>;

template <std::size_t count>
struct Definition {
    std::array<const char*, count> parameters;  ///< as they are declared; another declaration is refused
    nanobind::object (*body)(const Given<count>&);
};

/// Sorts the arguments of a vectorcall into the method's parameters; false if they do not fit.
bool bind_arguments(PyObject* method, PyObject* const* arguments, std::size_t flags, PyObject* keywords,
                    std::span<nanobind::handle> given);

/// Raises what Python raises when these arguments are given to the declaration. Returns null.
PyObject* refuse_arguments(PyObject* method, PyObject* const* arguments, std::size_t flags, PyObject* keywords);

template <const auto& definition>
PyObject* call_method(PyObject* method, PyObject* const* arguments, std::size_t flags, PyObject* keywords) noexcept {
    Given<definition.parameters.size()> given;
    if (!bind_arguments(method, arguments, flags, keywords, given))
        return refuse_arguments(method, arguments, flags, keywords);
    std::exception_ptr thrown;
    try {
        return definition.body(given).release().ptr();
    } catch (...) {
        thrown = std::current_exception();
        if (!thrown) hang();  // no exception of C++: the thread is being unwound
    }
    raise_in_python(thrown);
    return nullptr;
}

using Call = PyObject* (*)(PyObject*, PyObject* const*, std::size_t, PyObject*) noexcept;

/// The method for a declaration, which is a function of Python with these parameters.
nanobind::object make_method(nanobind::handle declaration, std::span<const char* const> parameters, Call call);

template <const auto& definition>
nanobind::object make_method(nanobind::handle declaration) {
    return make_method(declaration, definition.parameters, call_method<definition>);
}

}  // namespace crumple::python
