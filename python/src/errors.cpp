#include "errors.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <nanobind/stl/string.h>

#include "gil.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

// Names of ErrorCode and of Element in Python, in the order of the enumerators.
constexpr std::array code_names{
    "invalid_argument", "not_finite", "index_out_of_range", "memory_limit", "backend_unavailable", "file", "format",
    "cancelled",        "device",     "communication"};
constexpr std::array element_names{"none", "vertex", "triangle", "group", "option", "line",
                                   "byte", "body",   "shape",    "edge",  "point"};

const char* name_of(ErrorCode code) { return code_names[static_cast<std::size_t>(code)]; }
const char* name_of(Element element) { return element_names[static_cast<std::size_t>(element)]; }

// Returns the enumerator of a name, or the first one if there is none.
template <class Enum>
Enum found_by_name(const auto& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return static_cast<Enum>(found == names.end() ? 0 : found - names.begin());
}

const char* class_of(const Error& error) {
    if (dynamic_cast<const InvalidType*>(&error)) return "InvalidType";
    switch (error.code) {
        case ErrorCode::memory_limit:
            return "MemoryLimit";
        case ErrorCode::backend_unavailable:
            return "BackendUnavailable";
        case ErrorCode::file:
            return "FileError";
        case ErrorCode::cancelled:
        case ErrorCode::device:
        case ErrorCode::communication:
            return "Error";
        case ErrorCode::invalid_argument:
        case ErrorCode::not_finite:
        case ErrorCode::index_out_of_range:
        case ErrorCode::format:
            break;
    }
    return "InvalidInput";
}

// Replaces names of C++ members in a message by those of Python.
std::string in_words_of_python(std::string message) {
    constexpr std::pair<std::string_view, std::string_view> names[] = {
        {"open_edges lists", "crumple.open_edges lists"},
        {"OverlapQuery::weld", "weld=True"},
        {"OverlapQuery::open", "open=\"skip\""},
        {"IntersectionQuery::weld", "weld=True"},
        {"IntersectionQuery::open", "open=\"skip\""},
        {"IntersectionQuery::index", "index=True"},
        {"Options::backend", "the option backend of crumple.Detector"},
        {"Body::self", "self_collisions"},
        {"Shape::", "Shape."}};
    for (const auto& [member, name] : names)
        if (const std::size_t at = message.find(member); at != message.npos) message.replace(at, member.size(), name);
    return message;
}

void raise(const Error& error) {
    const nb::object type = nb::module_::import_("crumple._errors").attr(class_of(error));
    // File names need not be UTF-8: invalid bytes are written as \x80.
    const std::string what = in_words_of_python(error.what());
    const nb::object message =
        nb::steal(PyUnicode_DecodeUTF8(what.data(), static_cast<Py_ssize_t>(what.size()), "backslashreplace"));
    const nb::tuple given = nb::make_tuple(message);
    nb::dict place;
    place["code"] = name_of(error.code);
    place["element"] = name_of(error.element);
    place["index"] = error.index;
    place["bytes_needed"] = error.bytes_needed;
    place["rank"] = error.rank;
    const nb::object exception =
        nb::steal(in_python([&] { return PyObject_Call(type.ptr(), given.ptr(), place.ptr()); }));
    if (!exception) throw nb::python_error();
    if (error.system_error) {
        exception.attr("errno") = error.system_error;
        exception.attr("strerror") = std::generic_category().message(error.system_error);
    }
    PyErr_SetObject(type.ptr(), exception.ptr());
}

void translate(const std::exception_ptr& pointer, void*) {
    if (!pointer) hang();  // no C++ exception, but pthread_exit: the interpreter has ended
    const Error* known = nullptr;
    try {
        std::rethrow_exception(pointer);
    } catch (const Error& error) {
        known = &error;
    } catch (const std::bad_alloc&) {
        PyErr_SetString(PyExc_MemoryError, "the machine has no memory left for this call");
        return;
    }
    raise(*known);
}

}  // namespace

void translate_errors() { nb::register_exception_translator(translate); }

std::optional<Error> error_of(nb::handle exception) {
    if (!nb::isinstance(exception, nb::module_::import_("crumple._errors").attr("Error"))) return std::nullopt;
    return Error(found_by_name<ErrorCode>(code_names, nb::cast<std::string>(exception.attr("code"))),
                 nb::str(exception).c_str(),
                 found_by_name<Element>(element_names, nb::cast<std::string>(exception.attr("element"))),
                 nb::cast<std::int64_t>(exception.attr("index")));
}

}  // namespace crumple::python
