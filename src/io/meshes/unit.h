#pragma once

// Units as file formats have them.

#include <optional>
#include <string_view>

#include "crumple/io.h"

namespace crumple::io {

/// As 3MF writes it; an unknown one as millimetre, for 3MF has to say something.
const char* name_in_3mf(Unit unit);
/// The unit that 3MF calls so.
std::optional<Unit> unit_in_3mf(std::string_view name);
double metres_in(Unit unit);

/// Throws Error (invalid_argument) if the units of two meshes are known and different.
void check_same_unit(Unit a, Unit b);

}  // namespace crumple::io
