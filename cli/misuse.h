#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace crumple::cli {

/// Returns a message about the command line that `app` could not parse: the name of the command, CLI11's message, and
/// either the option or command that was probably meant, or the new name of an option of version 0.2, or how to get
/// help.
std::string explain(const CLI::ParseError& error, const CLI::App& app);

}  // namespace crumple::cli
