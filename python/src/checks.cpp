#include "checks.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arguments.h"
#include "arrays.h"
#include "checks/check_report.h"
#include "checks/check_writers.h"
#include "checks/given_length.h"
#include "detector.h"
#include "files.h"
#include "io/bytes/atomic_file.h"
#include "io/formats.h"
#include "io/meshes/common_unit.h"
#include "io/meshes/weld.h"
#include "io/scenes/body_names.h"
#include "io/scenes/world_mesh.h"
#include "names.h"
#include "world_files.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

using checks::CheckReport, checks::CheckWriter;
nb::object text_by(CheckWriter write, const CheckReport& report) {
    std::ostringstream out;
    {
        const WithoutGil released;
        write(out, report);
    }
    return to_str(out.str());
}

/// Bodies of a check, read one after another.
struct GivenBodies {
    io::WorldMesh world;
    io::BodyOrigins origins;
    std::vector<std::string> messages;
    io::CommonUnit unit;

    explicit GivenBodies(bool strict)
        : unit(
              strict, "unit= states a unit for the former",
              [this](const std::string& text) { messages.push_back(text); },
              [this](const std::string& text) { messages.push_back(text); }) {}

    void add(io::WorldMesh part, const std::string& name) {
        messages.insert(messages.end(), part.warnings.begin(), part.warnings.end());
        unit.apply(name, part);
        io::append(std::move(part), world);
        origins.files += (origins.files.empty() ? "" : ", ") + name;
        origins.file_of_body.resize(world.bodies.size(), name);
    }
    void name_bodies() {
        io::make_names_unique(world.bodies);
        for (const io::NamedBody& body : world.bodies) origins.names.push_back(body.name);
    }
};

/// Changes a part that was not read from a file as reading would have changed it.
void read_as(const io::ReadOptions& options, io::WorldMesh& part) {
    if (options.weld == io::Weld::yes)
        for (io::TriangleMesh& shape : part.shapes) io::weld(shape);
    if (options.unit != io::Unit::unknown) io::convert_unit(part, options.unit);
    io::validate(part);
}

/// Returns a part of the check as a world. `given`: (path,), (mesh, name) or (world, poses, names).
io::WorldMesh world_of(const nb::tuple& given, const io::ReadOptions& options, std::string& name) {
    if (given.size() == 1) {
        const std::filesystem::path file = python::path("path", given[0]);
        name = file.string();
        const WithoutGil released;
        return io::read_world(file, options);
    }
    io::WorldMesh part;
    if (given.size() == 2) {
        name = std::string(text("names", given[1]));
        const nb::tuple arrays = nb::borrow<nb::tuple>(given[0]);
        const BorrowedMesh mesh(arrays);
        part = io::world_of(copy_of(mesh.view()), name);
        part.unit = part.shapes[0].unit = unit_of(nb::getattr(arrays, "unit", nb::none()));
    } else {
        name = "world";
        part = copy_of(given[0], given[1], nb::cast<std::vector<std::string>>(given[2]));
        for (io::TriangleMesh& shape : part.shapes) shape.unit = part.unit;
    }
    const WithoutGil released;
    read_as(options, part);
    return part;
}

/// Returns a length in the unit of the bodies, from a number or from a text such as "0.1mm".
double length_in(io::Unit unit, const char* argument, nb::handle value) {
    checks::GivenLength length;
    if (!PyUnicode_Check(value.ptr())) {
        length.value = real(argument, value);
    } else if (const auto given = checks::length_of(std::string(text(argument, value)))) {
        length = *given;
    } else {
        refuse(std::string(argument) +
               " must be a length such as \"0.1mm\", or a number in the unit of the bodies, not " +
               nb::repr(value).c_str());
    }
    if (!(length.value >= 0)) refuse(std::string(argument) + " must not be negative, nor NaN");
    const std::optional<double> result = length.in(unit);
    if (!result) refuse(std::string(argument) + ": the bodies have no unit; state it by unit=, or give a number");
    return *result;
}

std::int32_t index_of(const std::vector<std::string>& names, nb::handle name) {
    const std::string wanted(text("excluded_bodies", name));
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found == names.end()) refuse("excluded_bodies: there is no body " + io::quoted_name(wanted));
    return static_cast<std::int32_t>(found - names.begin());
}

/// Returns (report, messages). `parts`: list of tuples as for world_of(). `excluded`: list of pairs of names.
nb::tuple check(SharedDetector& detector, const nb::list& parts, nb::handle ignore_below, nb::handle clearance,
                const nb::list& excluded, nb::handle precision, nb::handle weld, nb::handle triangulation,
                nb::handle strict, nb::handle unit) {
    const io::ReadOptions options = read_options(precision, weld, triangulation, strict, unit);
    GivenBodies given(options.strict);
    for (const nb::handle part : parts) {
        std::string name;
        io::WorldMesh world = world_of(nb::borrow<nb::tuple>(part), options, name);
        given.add(std::move(world), name);
    }
    given.name_bodies();
    if (given.world.bodies.empty()) refuse("check needs bodies; there are none");
    checks::CheckOptions check{length_in(given.world.unit, "ignore_below", ignore_below), {}};
    if (!clearance.is_none()) check.clearance = length_in(given.world.unit, "clearance", clearance);
    checks::CheckInput input{given.world, given.origins};
    for (const nb::handle pair : excluded)
        input.excluded.push_back({index_of(given.origins.names, pair[0]), index_of(given.origins.names, pair[1])});
    auto report = std::make_shared<CheckReport>();
    {
        const SharedDetector::Turn turn(detector);
        *report = without_gil(
            [&] {
                return detector.call([&](Detector& by, std::stop_token stop) {
                    return checks::check_bodies(by, input, check, std::move(stop));
                });
            },
            detector.stop());
    }
    nb::list messages;
    for (const std::string& message : given.messages) messages.append(to_str(message));
    return nb::make_tuple(nb::cast(std::move(report)), messages);
}

void save(const CheckReport& report, nb::handle path) {
    const std::filesystem::path to = python::path("path", path);
    const CheckWriter write = checks::check_writer_of(io::extension_of(to));
    if (!write) refuse(to.string() + ": a check is saved as .txt, .csv, .json or .html");
    const WithoutGil released(at_exit(to));
    io::AtomicFile file(to);
    write(file.stream(), report);
    file.commit();
}

}  // namespace

void bind_checks(nb::module_& module) {
    nb::class_<CheckReport>(module, "Check")
        .def("text", [](const CheckReport& report) { return text_by(checks::write_check_text, report); })
        .def("json", [](const CheckReport& report) { return text_by(checks::write_check_json, report); })
        .def("save", save, "path"_a.none());
    module.def("check", check, "detector"_a, "parts"_a, "ignore_below"_a.none(), "clearance"_a.none(), "excluded"_a,
               "precision"_a.none(), "weld"_a.none(), "triangulation"_a.none(), "strict"_a.none(), "unit"_a.none());
}

}  // namespace crumple::python
