#include "cli/help.h"

#include <sstream>

namespace crumple::cli {
namespace {

constexpr std::size_t indent = 8, width = 80;

}  // namespace

std::string Help::make_option(const CLI::Option* option, bool positional) const {
    const std::string value = option->get_type_name();
    std::string text =
        "  " + (positional ? value : option->get_name(false, true) + (value.empty() ? "" : " " + value)) + "\n";
    std::istringstream words(option->get_description());
    std::string line;
    for (std::string word; words >> word;) {
        if (indent + line.size() + 1 + word.size() > width) {
            text += std::string(indent, ' ') + line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return text + std::string(indent, ' ') + line + "\n";
}

std::string Help::make_option_usage(const CLI::Option* option) const {
    return option->get_required() ? option->get_type_name() : "[" + option->get_type_name() + "]";
}

}  // namespace crumple::cli
