#pragma once

// Options whose value is a length: a number with a unit, or a number in the unit of the files.

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "crumple/io.h"

namespace crumple::cli {

struct GivenLength {
    double value = 0;
    io::Unit unit = io::Unit::unknown;  ///< unknown: that of the files
    std::string option = {};            ///< the option and its value, for messages: "--clearance 0.1mm"

    /// Returns the length in another unit. Throws Error (invalid_argument) if this length has a unit and `to` is
    /// unknown.
    double in(io::Unit to) const;
};

/// Parses "0.01mm", "0.01 mm" or "0.01": a finite number of 0 or more, and the short name of a unit (io::name_of).
/// Returns nothing for other texts.
std::optional<GivenLength> length_of(const std::string& text);

/// Adds an option with a length.
CLI::Option* add_length_option(CLI::App& app, const char* name, std::optional<GivenLength>& length, const char* help);

}  // namespace crumple::cli
