#pragma once

// Options whose value is one of a few words.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace crumple::cli {

template <class Value>
using Choices = std::vector<std::pair<std::string, Value>>;

/// Returns the words of all choices, for help: "cpu|cuda".
template <class Value>
std::string words_of(const Choices<Value>& choices) {
    std::string words;
    for (const auto& [word, value] : choices) words += (words.empty() ? "" : "|") + word;
    return words;
}

/// Returns the value of the word `text`. Throws CLI::ValidationError if it is not among the choices. `name`: name of
/// the option, for the message.
template <class Value>
Value chosen(const char* name, const std::string& text, const Choices<Value>& choices) {
    const auto found = std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.first == text; });
    if (found == choices.end()) throw CLI::ValidationError(name, text + " is not one of " + words_of(choices));
    return found->second;
}

template <class Target, class Value>
CLI::Option* add_choice(CLI::App& app, const char* name, Target& target, Choices<Value> choices, const char* help) {
    const auto set = [&target, choices, name](const std::string& text) { target = chosen(name, text, choices); };
    return app.add_option_function<std::string>(name, set, help)->type_name(words_of(choices));
}

}  // namespace crumple::cli
