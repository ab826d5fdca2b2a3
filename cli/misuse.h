#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace crumple::cli {

/// What is wrong with the command line that `app` could not parse, in one sentence that names the word at fault and the
/// command.
std::string explain(const CLI::ParseError& error, const CLI::App& app);

}  // namespace crumple::cli
