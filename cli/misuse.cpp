// Messages about wrong use: adds to CLI11's message the command, and the option or command that was probably meant, or
// the new name of an option of an earlier version.

#include "cli/misuse.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

namespace crumple::cli {
namespace {

/// Returns how many edits turn one word into the other, where an edit adds, removes or changes a letter.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t k = 0; k < b.size(); ++k) {
            const std::size_t changed = diagonal + (a[i] != b[k]);
            diagonal = std::exchange(row[k + 1], std::min({changed, row[k] + 1, row[k + 1] + 1}));
        }
    }
    return row.back();
}

/// Returns the command's long options and its subcommands.
std::vector<std::string> words_of(const CLI::App& command) {
    std::vector<std::string> words;
    for (const CLI::Option* const option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
    }
    for (const CLI::App* const child : command.get_subcommands([](const CLI::App*) { return true; }))
        words.push_back(child->get_name());
    return words;
}

/// Options of version 0.2, and their present names.
constexpr std::pair<std::string_view, std::string_view> renamed_options[] = {
    {"--any", "--any-by-world"},
    {"--earliest", "--first"},
    {"--exclude", "--excluded-bodies"},
    {"--exclude-from", "--excluded-bodies-from"},
    {"--intersections", "--kind"},
    {"--kind", "--triangle-pairs or --candidates"},
    {"--near", "--radius"},
    {"--separation", "--min-distance"},
    {"--separation-share", "--min-distance-share"},
    {"--wanted", "--filter"},
};

/// Returns "; it is --filter now" if the command had this option under another name in an earlier version, or "; did
/// you mean --neighbours?" if it has an option or subcommand of a similar name; else an empty text.
std::string suggestion(const std::string& argument, const CLI::App& command) {
    const std::string word = argument.substr(0, argument.find('='));
    for (const auto& [old_name, name] : renamed_options)
        if (word == old_name && command.get_option_no_throw(std::string(name.substr(0, name.find(' ')))))
            return "; it is " + std::string(name) + " now";
    std::string nearest;
    // `least` is the edit distance that a word must be below to be suggested: at first a third of the letters, or a
    // third plus one for words of more than eight letters; then the distance of the best word so far.
    std::size_t least = word.size() / 3 + (word.size() > 8);
    for (const std::string& known : words_of(command)) {
        const bool begins = known.starts_with(word) && word.size() > 3;
        const std::size_t distance = begins ? 0 : edit_distance(word, known);
        if (distance >= least) continue;
        least = distance;
        nearest = known;
    }
    return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

}  // namespace

std::string explain(const CLI::ParseError& error, const CLI::App& app) {
    const auto chosen = app.get_subcommands();
    const CLI::App& command = chosen.empty() ? app : *chosen.front();
    const std::string prefix = chosen.empty() ? "" : command.get_name() + ": ";
    std::string message = prefix + error.what();
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
        const std::vector<std::string> words = app.remaining(true);  // the error's own text has them in another order
        for (const std::string& word : words) {
            const std::string meant = suggestion(word, command);
            if (!meant.empty()) return fmt::format("{}not expected: {}{}", prefix, word, meant);
        }
        message = fmt::format("{}not expected: {}", prefix, fmt::join(words, " "));
    }
    return message + "; see crumple " + (chosen.empty() ? "" : command.get_name() + " ") + "--help";
}

}  // namespace crumple::cli
