#pragma once

#include <CLI/CLI.hpp>

namespace crumple::cli {

/// Formatter of help texts in 80 columns. Shows values and positional arguments by their CLI11 `type_name` only. Groups
/// options, the most common ones first.
class Help : public CLI::Formatter {
   public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
    std::string make_option(const CLI::Option* option, bool positional) const override;
    std::string make_option_usage(const CLI::Option* option) const override;
};

}  // namespace crumple::cli
