#include "cli/common_unit.h"

#include <fmt/format.h>

#include "cli/terminal.h"
#include "crumple/error.h"

namespace crumple::cli {

void CommonUnit::apply(const std::string& file, io::TriangleMesh& mesh) { convert(file, mesh); }
void CommonUnit::apply(const std::string& file, io::WorldMesh& world) { convert(file, world); }

template <class Mesh>
void CommonUnit::convert(const std::string& file, Mesh& mesh) {
    if (mesh.unit == io::Unit::unknown) {
        if (unknown_.empty()) unknown_ = file;
        if (unit_ != io::Unit::unknown) warn(file, file_, unit_);
    } else if (unit_ == io::Unit::unknown) {
        file_ = file, unit_ = mesh.unit;
        if (!unknown_.empty()) warn(unknown_, file_, unit_);
    } else if (mesh.unit != unit_) {
        const char* const from = io::name_of(mesh.unit);
        io::convert_unit(mesh, unit_);
        print_note(
            fmt::format("{} is converted from {} to {}, the unit of {}: results are exact for the converted "
                        "coordinates, which are rounded, so that surfaces that touch may no longer do so",
                        file, from, io::name_of(unit_), file_));
    }
}

void CommonUnit::warn(const std::string& unknown, const std::string& known, io::Unit unit) {
    const std::string what = fmt::format(
        "{} states no unit, and {} states {}: their numbers are compared as they are "
        "(--unit states a unit for the former)",
        unknown, known, io::name_of(unit));
    if (strict_) throw Error(ErrorCode::invalid_argument, what, Element::option);
    if (!warned_) print_warning(what);
    warned_ = true;
}

}  // namespace crumple::cli
