// Wrong use in plain words: CLI11 tells what its parser expected, which is not always what a user can mend.

#include "cli/misuse.h"

#include <algorithm>
#include <numeric>
#include <regex>
#include <utility>
#include <vector>

namespace crumple::cli {
namespace {

bool is_option(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

std::string commands_of(const CLI::App& app) {
    std::string names;
    const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::App* command : commands) {
        names += names.empty() ? "" : command == commands.back() ? " or " : ", ";
        names += command->get_name();
    }
    return names;
}

/// How many letters have to be added, taken away or changed to make one word of the other.
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

/// "; did you mean --neighbours?" if the command has an option of nearly this name.
std::string suggestion(const std::string& option, const CLI::App& command) {
    const std::string word = option.substr(0, option.find('='));
    std::string nearest;
    std::size_t least = word.size() / 3 + (word.size() > 8);  // below: a third of its letters, or one of a short word
    for (const CLI::Option* const known : command.get_options()) {
        for (const std::string& name : known->get_lnames()) {
            const bool begins = ("--" + name).starts_with(word) && word.size() > 3;
            const std::size_t distance = begins ? 0 : edit_distance(word, "--" + name);
            if (distance >= least) continue;
            least = distance;
            nearest = "--" + name;
        }
    }
    return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

/// Words that nothing takes.
std::string explain_extras(const CLI::App& app) {
    std::vector<std::string> words = app.remaining(true);
    const auto option = std::find_if(words.begin(), words.end(), is_option);
    const bool known_command = !app.get_subcommands().empty();
    const std::string command = known_command ? app.get_subcommands()[0]->get_name() : "crumple";
    if (option != words.end() && (known_command || words.front() == *option)) {
        const std::string meant = suggestion(*option, known_command ? *app.get_subcommands()[0] : app);
        if (!meant.empty()) return command + " has no option " + *option + meant;
        return command + " has no option " + *option + "; see crumple " + (known_command ? command + " " : "") +
               "--help";
    }
    if (!known_command) return words.front() + " is no command: " + commands_of(app);
    return command + " has no use for the argument " + words.front() + "; see crumple " + command + " --help";
}

/// "--triangles: At Most 1 required but received 2", "--output: 1 required OUT missing".
std::string explain_count(const std::string& message) {
    std::smatch part;
    if (std::regex_match(message, part, std::regex("(.+): At Most (\\d+) required but received (\\d+)"))) {
        return part[1].str() + " is given " + part[3].str() + " times, and at most " + part[2].str() +
               (part[2] == "1" ? " is possible" : " are possible");
    }
    if (std::regex_match(message, part, std::regex("(.+): At least (\\d+) required but received (\\d+)"))) {
        return part[1].str() + ": at least " + part[2].str() + " are needed, not " + part[3].str();
    }
    if (std::regex_match(message, part, std::regex("(.+): \\d+ required (.+) missing"))) {
        return part[1].str() + " needs a value: " + part[2].str();
    }
    return message;
}

/// "Could not convert: --frame = x", "--threads: Value two not in range 1 to 1024": every range is one of integers.
std::string explain_value(const std::string& message) {
    std::smatch part;
    if (std::regex_match(message, part, std::regex("Could not convert: (\\S+) = (.*)"))) {
        return part[1].str() + ": " + part[2].str() + " is not what it takes";
    }
    return std::regex_replace(message, std::regex("Value (.*) not in range (\\d+) to (\\d+)"),
                              "$1 is no integer from $2 to $3");
}

}  // namespace

std::string explain(const CLI::ParseError& error, const CLI::App& app) {
    std::string message = error.what();
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) return explain_extras(app);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return explain_count(message);
    if (dynamic_cast<const CLI::ConversionError*>(&error) || dynamic_cast<const CLI::ValidationError*>(&error)) {
        return explain_value(message);
    }
    if (dynamic_cast<const CLI::ExcludesError*>(&error)) {
        return std::regex_replace(message, std::regex("(.+) excludes (.+)"), "$1 and $2 exclude each other");
    }
    const auto commands = app.get_subcommands();
    if (dynamic_cast<const CLI::RequiredError*>(&error) && !commands.empty()) {
        return commands[0]->get_name() + ": " + message + "; see crumple " + commands[0]->get_name() + " --help";
    }
    return message;
}

}  // namespace crumple::cli
