// crumple info: reports on the contents of a file.

#include <algorithm>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "checks/body_report.h"
#include "cli/bodies_of_files.h"
#include "cli/commands.h"
#include "cli/terminal.h"
#include "crumple/device.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

using checks::BodyReport, checks::describe, checks::posed_body, checks::text_of_point;

/// Returns the number of triangles and, in parentheses, at most five of them: "3 (5, 17, 40)".
std::string some(const std::vector<std::int32_t>& triangles) {
    constexpr std::size_t most = 5;
    std::string text = grouped(static_cast<std::int64_t>(triangles.size()));
    if (triangles.empty()) return text;
    const auto end = triangles.begin() + static_cast<std::ptrdiff_t>(std::min(most, triangles.size()));
    return text +
           fmt::format(" ({}{})", fmt::join(triangles.begin(), end, ", "), end == triangles.end() ? "" : ", ...");
}

class Printer {
   public:
    Printer(std::ostream& out, io::Unit unit) : out_(out), unit_(unit) {}

    void row(std::string_view name, const std::string& value) { out_ << fmt::format("{:<22}{}\n", name, value); }

    void print_unit() { row("unit", io::name_of(unit_)); }

    void print(const io::TriangleMesh& mesh, const BodyReport& report) {
        row("vertices", fmt::format("{} ({} unused)", grouped(report.vertices), grouped(report.unused)));
        row("triangles", grouped(report.triangles));
        row("precision", report.precision);
        if (report.box)
            row("box",
                fmt::format("{} to {}", text_of_point(mesh, report.box->low), text_of_point(mesh, report.box->high)));
        row("degenerate triangles", some(report.degenerate));
        row("duplicated triangles", some(report.duplicated));
        row("open edges", grouped(std::ssize(report.edges.open)));
        for (std::size_t i = 0; i < std::min(BodyReport::most_edges, report.edges.open.size()); ++i)
            row(i ? "" : "  the first", describe(mesh, report.edges.open[i]));
        if (report.listed) print_list(mesh, *report.listed);
        row("holes", grouped(report.edges.holes));
        row("non-manifold edges", grouped(report.edges.non_manifold));
        row("orientation", report.edges.flipped ? "not consistent" : "consistent");
        if (const auto& flipped = report.edges.flipped)
            row("  the first", fmt::format("triangles {} and {} run along edge {}, in the same direction",
                                           flipped->first, flipped->second, describe(mesh, flipped->edge)));
        row("connected components", grouped(report.components));
        row("closed", report.triangles == 0 ? "no: there are no triangles" : report.edges.closed ? "yes" : "no");
        row("volume", volume_of(report));
    }

   private:
    void print_list(const io::TriangleMesh& mesh, const Array<OpenEdge>& edges) {
        row("list of open edges", grouped(static_cast<std::int64_t>(edges.size())));
        for (const OpenEdge& open : edges)
            row("", fmt::format("{}, of triangle {}", describe(mesh, open.edge), open.triangle));
    }

    std::string volume_of(const BodyReport& report) const {
        if (!report.volume) return "none: the surface is not closed, or not consistently oriented";
        return fmt::format("{:.6g}{}{}", *report.volume,
                           unit_ == io::Unit::unknown ? "" : fmt::format(" {}^3", io::name_of(unit_)),
                           *report.volume < 0 ? ": the surface is inside out" : "");
    }

    std::ostream& out_;
    io::Unit unit_;
};

struct Info {
    std::string file;
    ReadingOptions reading;
    bool json = false, check = false, open_edges = false;

    int run() const {
        const io::WorldMesh world = read_bodies({file}, reading);
        const auto bodies = world.bodies.size();
        const auto body = [&](std::size_t b) -> const io::NamedBody& { return world.bodies[b]; };
        bool sound = bodies > 0;
        nlohmann::json list = nlohmann::json::array();
        to_standard_output([&](std::ostream& out) {
            Printer printer(out, world.unit);
            const bool scene = is_scene() || bodies != 1;
            if (!json && scene) print_bodies(printer, world);
            if (!json && !scene) printer.print_unit();
            for (std::size_t b = 0; b < bodies; ++b) {
                const bool is_posed = body(b).pose != Pose{};
                const io::TriangleMesh moved = is_posed ? posed_body(world, b) : io::TriangleMesh();
                const io::TriangleMesh& posed =
                    is_posed ? moved : world.shapes[static_cast<std::size_t>(body(b).shape)];
                const BodyReport report(posed, open_edges);
                sound = sound && report.is_sound();
                if (json) {
                    list.push_back(checks::json_of(body(b).name, posed, report));
                    continue;
                }
                if (scene) {
                    out << '\n';
                    printer.row(fmt::format("body {}", b), quoted_name(body(b).name));
                    printer.row("shape", std::to_string(body(b).shape));
                }
                printer.print(posed, report);
            }
            if (json) print_json(out, world, std::move(list));
        });
        return check && !sound ? collided : done;
    }

   private:
    /// True if the file is a scene. Decides by its name, because a scene may have a single body, like a mesh.
    bool is_scene() const {
        const std::string extension = extension_of(file);
        return extension == ".glb" || extension == ".gltf" || extension == ".3mf";
    }

    /// Prints the numbers of bodies, shapes and triangles, and the unit. The caller then prints each body, in the order
    /// in which --poses of other commands expects their poses.
    static void print_bodies(Printer& printer, const io::WorldMesh& world) {
        printer.row("bodies", grouped(std::ssize(world.bodies)));
        printer.row("shapes", grouped(std::ssize(world.shapes)));
        printer.row("triangles", grouped(world.triangle_count()));
        printer.print_unit();
    }

    void print_json(std::ostream& out, const io::WorldMesh& world, nlohmann::json bodies) const {
        const nlohmann::json unit =
            world.unit == io::Unit::unknown ? nlohmann::json() : nlohmann::json(io::name_of(world.unit));
        const nlohmann::ordered_json all{{"file", file}, {"unit", unit}, {"bodies", std::move(bodies)}};
        out << all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    }
};

/// Returns a line for each device, or the reason why there is none.
std::string describe_devices() {
    const DeviceList list = list_devices();
    if (list.devices.empty()) return "none: " + list.reason;
    std::vector<std::string> lines;
    for (const DeviceInfo& d : list.devices) {
        lines.push_back(fmt::format("{}  {}, compute capability {}.{}, {}", d.number, d.name, d.major, d.minor,
                                    readable_bytes(d.memory_bytes)));
    }
    return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace

Command add_info(CLI::App& app) {
    const auto info = std::make_shared<Info>();
    CLI::App& command =
        *app.add_subcommand("info", "Show what a mesh file contains, and whether it is the surface of a solid");
    command
        .add_option("FILE", info->file,
                    "A mesh (PLY, OBJ, STL, OFF), a scene (.glb, .gltf, .3mf), or - for standard input")
        ->type_name("FILE")
        ->required();
    add_reading_options(command, info->reading);
    command.add_flag("--json", info->json, "Write the same as JSON");
    command.add_flag("--check", info->check,
                     "Exit with status 1 unless every body is closed, consistently oriented, not inside out, and "
                     "without degenerate triangles. crumple check also checks whether a body passes through itself");
    command.add_flag("--open-edges", info->open_edges,
                     "List all open edges of each body: those that occur in its triangles more often in one direction "
                     "than in the other, such as an edge that two triangles traverse in the same direction; each with "
                     "the lowest of these triangles. crumple overlap needs bodies without open edges");
    // Adds --devices as CLI11's version flag, which prints a text and exits without requiring a file.
    command.set_version_flag("--devices", describe_devices,
                             "List the devices of the cuda backend, or the reason why there is none, and exit");
    command.footer(
        "Closed: every edge has two triangles, or another even number. Degenerate and duplicated triangles are found\n"
        "by exact tests on positions; edges, holes and components depend on vertex indices, so files without shared\n"
        "vertices need --weld. Bodies of a scene are described under their poses.\n"
        "Example: crumple info part.stl --check\n"
        "         crumple info scan.ply --weld --open-edges");
    return {&command, [info] { return info->run(); }};
}

}  // namespace crumple::cli
