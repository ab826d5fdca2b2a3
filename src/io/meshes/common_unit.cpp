#include "io/meshes/common_unit.h"

#include "crumple/error.h"

namespace crumple::io {

void CommonUnit::apply(const std::string& file, TriangleMesh& mesh) { convert(file, mesh); }
void CommonUnit::apply(const std::string& file, WorldMesh& world) { convert(file, world); }

template <class Mesh>
void CommonUnit::convert(const std::string& file, Mesh& mesh) {
    if (mesh.unit == Unit::unknown) {
        if (unknown_.empty()) unknown_ = file;
        if (unit_ != Unit::unknown) warn(file, file_, unit_);
    } else if (unit_ == Unit::unknown) {
        file_ = file, unit_ = mesh.unit;
        if (!unknown_.empty()) warn(unknown_, file_, unit_);
    } else if (mesh.unit != unit_) {
        const char* const from = name_of(mesh.unit);
        convert_unit(mesh, unit_);
        note_(
            file + " is converted from " + from + " to " + name_of(unit_) + ", the unit of " + file_ +
            ": results are exact for the converted coordinates, which are rounded, so that surfaces that touch may no "
            "longer do so");
    }
}

void CommonUnit::warn(const std::string& unknown, const std::string& known, Unit unit) {
    const std::string what = unknown + " states no unit, and " + known + " states " + name_of(unit) +
                             ": their numbers are compared as they are (" + advice_ + ")";
    if (strict_) throw Error(ErrorCode::invalid_argument, what, Element::option);
    if (!warned_) warn_(what);
    warned_ = true;
}

}  // namespace crumple::io
