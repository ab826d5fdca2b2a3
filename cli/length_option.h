#pragma once

// Options whose value is a length: a number with a unit, or a number in the unit of the files.

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "checks/given_length.h"

namespace crumple::cli {

struct LengthOption {
    checks::GivenLength length;
    std::string text;  ///< the option and its value, for messages: "--clearance 0.1mm"

    /// Returns the length in the unit of the files. Throws Error (invalid_argument) if only the length has a unit.
    double in(io::Unit unit) const;
};

/// Adds an option with a length.
CLI::Option* add_length_option(CLI::App& app, const char* name, std::optional<LengthOption>& option, const char* help);

}  // namespace crumple::cli
