#pragma once

// Arguments of a Python call, by the names that they have there. What is of another type is an InvalidType, what is out
// of range an InvalidInput; either says which argument, what it must be and what it is.

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include <nanobind/nanobind.h>

#include "errors.h"

namespace crumple::python {

/// Throws InvalidType: "weld must be True or False, not str".
[[noreturn]] void refuse_type(std::string_view argument, std::string_view wanted, nanobind::handle value);

/// True or False, NumPy's too.
bool flag(std::string_view argument, nanobind::handle value);

/// A str; valid as long as the value.
std::string_view text(std::string_view argument, nanobind::handle value);

/// What converts to float without loss of meaning: not a str.
double real(std::string_view argument, nanobind::handle value);

/// A str, bytes or os.PathLike.
std::filesystem::path path(std::string_view argument, nanobind::handle value);

/// An int, or anything that Python takes for an index, such as NumPy's integers.
nanobind::object any_integer(std::string_view argument, nanobind::handle value);

/// The same within the limits of `Integer`.
template <class Integer>
Integer integer(std::string_view argument, nanobind::handle value) {
    const nanobind::object number = any_integer(argument, value);
    Integer result = 0;
    if (nanobind::try_cast(number, result)) return result;
    refuse(std::string(argument) + " must be from " + std::to_string(std::numeric_limits<Integer>::min()) + " to " +
           std::to_string(std::numeric_limits<Integer>::max()) + ", not " + nanobind::repr(number).c_str());
}

}  // namespace crumple::python
