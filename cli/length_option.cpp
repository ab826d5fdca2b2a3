#include "cli/length_option.h"

#include <cmath>

#include "cli/bodies_of_files.h"
#include "io/bytes/text.h"
#include "io/meshes/unit.h"

namespace crumple::cli {

double GivenLength::in(io::Unit to) const {
    if (unit == io::Unit::unknown || unit == to) return value;
    if (to == io::Unit::unknown)
        refuse(option + ": the files state no unit; state it by --unit, or leave out the unit of the length");
    return value * (io::metres_in(unit) / io::metres_in(to));
}

std::optional<GivenLength> length_of(const std::string& text) {
    const std::size_t end = text.find_last_of("0123456789.") + 1;  // npos + 1 is 0
    const std::optional<double> number = io::number_of(text.substr(0, end));
    if (!number || !std::isfinite(*number) || *number < 0) return std::nullopt;
    const std::size_t name = text.find_first_not_of(' ', end);
    if (name == text.npos) return GivenLength{*number};
    for (const io::Unit unit : {io::Unit::micrometre, io::Unit::millimetre, io::Unit::centimetre, io::Unit::inch,
                                io::Unit::foot, io::Unit::metre})
        if (text.substr(name) == io::name_of(unit)) return GivenLength{*number, unit};
    return std::nullopt;
}

CLI::Option* add_length_option(CLI::App& app, const char* name, std::optional<GivenLength>& length, const char* help) {
    const auto read = [&length, name](const std::string& text) {
        length = length_of(text);
        if (!length)
            throw CLI::ValidationError(name, text + " is not a length, such as 0.1mm, or 0.1 in the unit of the files");
        length->option = std::string(name) + ' ' + text;
    };
    return app.add_option_function<std::string>(name, read, help)->type_name("LENGTH");
}

}  // namespace crumple::cli
