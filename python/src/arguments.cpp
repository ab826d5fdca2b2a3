#include "arguments.h"

#include <initializer_list>

#include "gil.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

std::string name_of_type(nb::handle value) {
    const nb::handle type = value.type();
    const std::string module = nb::str(type.attr("__module__")).c_str();
    const std::string name = nb::str(type.attr("__qualname__")).c_str();
    return module == "builtins" ? name : module + "." + name;
}

// Clears the current Python error if it is of one of the types `blaming`, which mean that the argument is wrong. Throws
// any other error, such as a KeyboardInterrupt in the argument's __index__.
void check_cause(std::initializer_list<PyObject*> blaming) {
    for (PyObject* const type : blaming)
        if (PyErr_ExceptionMatches(type)) return PyErr_Clear();
    throw nb::python_error();
}

}  // namespace

void refuse_type(std::string_view argument, std::string_view wanted, nb::handle value) {
    throw InvalidType(std::string(argument) + " must be " + std::string(wanted) + ", not " +
                      (value.is_none() ? "None" : name_of_type(value)));
}

bool flag(std::string_view argument, nb::handle value) {
    if (value.is(Py_False)) return false;
    if (value.is(Py_True)) return true;
    const std::string name = name_of_type(value);
    if (name != "numpy.bool" && name != "numpy.bool_") refuse_type(argument, "True or False", value);
    return PyObject_IsTrue(value.ptr()) == 1;
}

std::string_view text(std::string_view argument, nb::handle value) {
    if (!PyUnicode_Check(value.ptr())) refuse_type(argument, "a str", value);
    Py_ssize_t size = 0;
    if (const char* const characters = PyUnicode_AsUTF8AndSize(value.ptr(), &size))
        return {characters, static_cast<std::size_t>(size)};
    check_cause({PyExc_UnicodeEncodeError});
    const nb::str shown = nb::steal<nb::str>(PyObject_ASCII(value.ptr()));
    refuse(std::string(argument) + " must be text that can be encoded as UTF-8, not " + shown.c_str());
}

double real(std::string_view argument, nb::handle value) {
    const double number = in_python([&] { return PyFloat_AsDouble(value.ptr()); });
    if (number != -1.0 || !PyErr_Occurred()) return number;
    const bool too_large = PyErr_ExceptionMatches(PyExc_OverflowError);
    check_cause({PyExc_TypeError, PyExc_OverflowError});
    if (too_large) refuse(std::string(argument) + " is outside the range of float64");
    refuse_type(argument, "a number", value);
}

std::filesystem::path path(std::string_view argument, nb::handle value) {
    PyObject* encoded = nullptr;
    if (!in_python([&] { return PyUnicode_FSConverter(value.ptr(), &encoded); })) {
        const bool wrong_type = PyErr_ExceptionMatches(PyExc_TypeError);
        check_cause({PyExc_TypeError, PyExc_ValueError});
        if (!wrong_type) refuse(std::string(argument) + " cannot be the name of a file");
        refuse_type(argument, "a str, bytes or os.PathLike", value);
    }
    const nb::bytes bytes = nb::steal<nb::bytes>(encoded);
    return std::filesystem::path(std::string(bytes.c_str(), bytes.size()));
}

nb::object any_integer(std::string_view argument, nb::handle value) {
    PyObject* const number = in_python([&] { return PyNumber_Index(value.ptr()); });
    if (number) return nb::steal(number);
    check_cause({PyExc_TypeError, PyExc_OverflowError});
    refuse_type(argument, "an integer", value);
}

}  // namespace crumple::python
