#pragma once

// Units of length in file formats.

#include <optional>
#include <string_view>

#include "crumple/io.h"

namespace crumple::io {

/// Returns the name of a unit in 3MF. For Unit::unknown returns "millimeter", the default of 3MF, which has no unknown
/// unit.
const char* name_in_3mf(Unit unit);
/// Returns the unit with this name in 3MF, or nothing if 3MF has no such unit.
std::optional<Unit> unit_in_3mf(std::string_view name);
double metres_in(Unit unit);

/// Throws Error (invalid_argument) if the units of two meshes are known and different.
void check_same_unit(Unit a, Unit b);

}  // namespace crumple::io
