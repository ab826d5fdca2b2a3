#pragma once

// Errors of the library as Python exceptions: the classes of crumple/_errors.py, with the same messages.

#include <optional>
#include <string>

#include <nanobind/nanobind.h>

#include "crumple/error.h"

namespace crumple::python {

/// Registers the translation of crumple::Error to Python. Call once, when the module is initialised.
void translate_errors();

/// Converts a Python exception of class crumple.Error to an Error; returns nothing for any other exception.
std::optional<Error> error_of(nanobind::handle exception);

/// Error for an argument of the wrong type.
struct InvalidType : Error {
    explicit InvalidType(const std::string& message) : Error(ErrorCode::invalid_argument, message, Element::option) {}
};

/// Throws Error (invalid_argument) about an argument of a Python call.
[[noreturn]] inline void refuse(const std::string& message) {
    throw Error(ErrorCode::invalid_argument, message, Element::option);
}

}  // namespace crumple::python
