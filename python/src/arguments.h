#pragma once

// Conversion of the arguments of Python calls. All functions throw InvalidType for a wrong type and Error
// (invalid_argument) for a value out of range; the message names the argument, the expected value and the actual one.

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include <nanobind/nanobind.h>

#include "errors.h"

namespace crumple::python {

/// Throws InvalidType with the argument's name, what it must be, and the type of `value`: "weld must be True or False,
/// not str".
[[noreturn]] void refuse_type(std::string_view argument, std::string_view wanted, nanobind::handle value);

/// Returns a bool of Python or NumPy.
bool flag(std::string_view argument, nanobind::handle value);

/// Returns the characters of a str in UTF-8, valid as long as `value`.
std::string_view text(std::string_view argument, nanobind::handle value);

/// Returns a number as float64, from anything that Python converts to float by __float__ or __index__; str is refused.
double real(std::string_view argument, nanobind::handle value);

/// Returns the path of a str, bytes or os.PathLike.
std::filesystem::path path(std::string_view argument, nanobind::handle value);

/// Returns a Python int, from anything that Python accepts as an index, such as NumPy's integers.
nanobind::object any_integer(std::string_view argument, nanobind::handle value);

/// Returns an integer. Throws Error if it is not within the limits of `Integer`.
template <class Integer>
Integer integer(std::string_view argument, nanobind::handle value) {
    const nanobind::object number = any_integer(argument, value);
    Integer result = 0;
    if (nanobind::try_cast(number, result)) return result;
    refuse(std::string(argument) + " must be from " + std::to_string(std::numeric_limits<Integer>::min()) + " to " +
           std::to_string(std::numeric_limits<Integer>::max()) + ", not " + nanobind::repr(number).c_str());
}

}  // namespace crumple::python
