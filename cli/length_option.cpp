#include "cli/length_option.h"

#include "cli/bodies_of_files.h"

namespace crumple::cli {

double LengthOption::in(io::Unit unit) const {
    if (const std::optional<double> value = length.in(unit)) return *value;
    refuse(text + ": the files state no unit; state it by --unit, or leave out the unit of the length");
}

CLI::Option* add_length_option(CLI::App& app, const char* name, std::optional<LengthOption>& option, const char* help) {
    const auto read = [&option, name](const std::string& text) {
        const std::optional<checks::GivenLength> length = checks::length_of(text);
        if (!length)
            throw CLI::ValidationError(name, text + " is not a length, such as 0.1mm, or 0.1 in the unit of the files");
        option = LengthOption{*length, std::string(name) + ' ' + text};
    };
    return app.add_option_function<std::string>(name, read, help)->type_name("LENGTH");
}

}  // namespace crumple::cli
