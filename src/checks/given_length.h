#pragma once

// Lengths of options: a number with a unit, or a number in the unit of the files.

#include <optional>
#include <string>

#include "crumple/io.h"

namespace crumple::checks {

struct GivenLength {
    double value = 0;
    io::Unit unit = io::Unit::unknown;  ///< unknown: that of the files

    /// Returns the length in another unit, or nothing if this length has a unit and `to` is unknown.
    std::optional<double> in(io::Unit to) const;
};

/// Parses "0.01mm", "0.01 mm" or "0.01": a finite number of 0 or more, and the short name of a unit (io::name_of).
/// Returns nothing for other texts.
std::optional<GivenLength> length_of(const std::string& text);

}  // namespace crumple::checks
