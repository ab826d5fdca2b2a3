#include "checks/given_length.h"

#include <cmath>

#include "io/bytes/text.h"
#include "io/meshes/unit.h"

namespace crumple::checks {

std::optional<double> GivenLength::in(io::Unit to) const {
    if (unit == io::Unit::unknown || unit == to) return value;
    if (to == io::Unit::unknown) return std::nullopt;
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

}  // namespace crumple::checks
