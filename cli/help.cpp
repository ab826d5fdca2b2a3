#include "cli/help.h"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace crumple::cli {
namespace {

constexpr std::size_t indent = 8, width = 80;

struct Group {
    const char* title;
    std::vector<std::string_view> options;
};

/// Groups of options, in the order in which help shows them. Options that are in none of these lists are shown at the
/// end of the first group.
const std::vector<Group>& groups() {
    static const std::vector<Group> all{
        {"Options",
         {"output", "check", "json", "contacts", "radius", "first", "triangle-pairs", "candidates", "overlaps",
          "leaves", "body-pairs", "groups", "filter", "help"}},
        {"What counts",
         {"neighbours",
          "kind",
          "polygons",
          "part",
          "min-distance",
          "min-distance-share",
          "approaching-only",
          "inflation",
          "kinds",
          "with-neighbours",
          "below",
          "radii",
          "rings",
          "rest",
          "rest-radius",
          "min-volume",
          "self-overlaps",
          "containment",
          "open",
          "regions",
          "depth-tolerance",
          "withdraw",
          "first-free",
          "ignore-below",
          "clearance"}},
        {"Bodies", {"excluded-bodies", "excluded-bodies-from", "poses", "any-by-world"}},
        {"Reading files", {"unit", "weld", "no-weld", "precision", "triangulation", "strict"}},
        {"Output format and progress", {"format", "stream", "repeat", "stats", "progress"}},
        {"Threads, memory and CUDA", {"threads", "memory-limit", "backend", "device", "devices"}},
        {"Method", {"clusters", "leaf-size", "sweep", "membership", "fuzzy-c-means"}},
    };
    return all;
}

std::size_t place_in(const Group& group, const CLI::Option* option) {
    const auto& names = option->get_lnames();
    const auto named = [&](std::string_view name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    return static_cast<std::size_t>(std::find_if(group.options.begin(), group.options.end(), named) -
                                    group.options.begin());
}

bool holds(const Group& group, const CLI::Option* option) { return place_in(group, option) < group.options.size(); }

}  // namespace

std::string Help::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
    if (mode == CLI::AppFormatMode::Sub) return Formatter::make_help(app, std::move(name), mode);
    std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app);
    for (const Group& group : groups()) {
        const bool first = &group == &groups().front();
        std::vector<const CLI::Option*> options = app->get_options([&](const CLI::Option* option) {
            const bool elsewhere =
                std::any_of(groups().begin(), groups().end(), [&](const Group& other) { return holds(other, option); });
            return option->nonpositional() && !option->get_group().empty() &&
                   (holds(group, option) || (first && !elsewhere));
        });
        std::stable_sort(options.begin(), options.end(), [&](const CLI::Option* a, const CLI::Option* b) {
            return place_in(group, a) < place_in(group, b);
        });
        if (!options.empty()) text += make_group(group.title, false, options);
    }
    return text + make_subcommands(app, mode) + '\n' + make_footer(app);
}

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
