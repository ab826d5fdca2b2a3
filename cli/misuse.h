#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace crumple::cli {

/// Returns CLI11's message about the command line that `app` could not parse, with the command, and either the word
/// that was probably meant or where to find help.
std::string explain(const CLI::ParseError& error, const CLI::App& app);

}  // namespace crumple::cli
