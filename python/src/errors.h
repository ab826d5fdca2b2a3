#pragma once

// Failures as Python exceptions: the classes of crumple/_errors.py, with the sentences of the C++ library.

#include <optional>
#include <string>

#include <nanobind/nanobind.h>

#include "crumple/error.h"

namespace crumple::python {

/// Lets crumple::Error cross into Python. Call once, at the module's start.
void translate_errors();

/// What a crumple.Error says, of its arguments; nothing of any other exception.
std::optional<Error> error_of(nanobind::handle exception);

/// An argument of a type that cannot be one.
struct InvalidType : Error {
    explicit InvalidType(const std::string& message) : Error(ErrorCode::invalid_argument, message, Element::option) {}
};

/// An Error (invalid_argument) about an argument of the Python call.
[[noreturn]] inline void refuse(const std::string& message) {
    throw Error(ErrorCode::invalid_argument, message, Element::option);
}

}  // namespace crumple::python
