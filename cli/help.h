#pragma once

#include <CLI/CLI.hpp>

namespace crumple::cli {

/// Help in 80 columns, with the words of `type_name` for values and positional arguments and nothing else. Options
/// stand in groups: first those that most people want.
class Help : public CLI::Formatter {
   public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
    std::string make_option(const CLI::Option* option, bool positional) const override;
    std::string make_option_usage(const CLI::Option* option) const override;
};

}  // namespace crumple::cli
