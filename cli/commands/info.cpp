// crumple info: reports on the contents of a file.

#include <algorithm>
#include <array>
#include <future>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "cli/bodies_of_files.h"
#include "cli/commands.h"
#include "cli/terminal.h"
#include "cli/topology.h"
#include "crumple/device.h"
#include "crumple/open_edges.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

/// Returns the number of triangles and, in parentheses, at most five of them: "3 (5, 17, 40)".
std::string some(const std::vector<std::int32_t>& triangles) {
    constexpr std::size_t most = 5;
    std::string text = grouped(static_cast<std::int64_t>(triangles.size()));
    if (triangles.empty()) return text;
    const auto end = triangles.begin() + static_cast<std::ptrdiff_t>(std::min(most, triangles.size()));
    return text +
           fmt::format(" ({}{})", fmt::join(triangles.begin(), end, ", "), end == triangles.end() ? "" : ", ...");
}

std::int64_t count_unused_vertices(const io::TriangleMesh& mesh) {
    std::vector<bool> used(static_cast<std::size_t>(mesh.vertex_count()));
    for (const std::int32_t corner : mesh.triangles) used[static_cast<std::size_t>(corner)] = true;
    return std::count(used.begin(), used.end(), false);
}

using Point = std::array<double, 3>;

Point point_of(const io::TriangleMesh& mesh, std::int32_t vertex) {
    const auto at = 3 * static_cast<std::size_t>(vertex);
    return std::visit(
        [at](const auto& xyz) {
            return Point{double{xyz[at]}, double{xyz[at + 1]}, double{xyz[at + 2]}};
        },
        mesh.vertices);
}

/// Returns coordinates as the shortest decimals that read back as the mesh's numbers.
std::string text_of_point(const io::TriangleMesh& mesh, const Point& p) {
    if (mesh.precision() == ScalarType::float64) return fmt::format("{}", fmt::join(p, " "));
    return fmt::format("{} {} {}", static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
}

struct BoundingBox {
    Point low, high;
};

std::optional<BoundingBox> box_of(const io::TriangleMesh& mesh) {
    if (mesh.vertex_count() == 0) return std::nullopt;
    BoundingBox box{point_of(mesh, 0), point_of(mesh, 0)};
    for (std::int32_t v = 1; v < mesh.vertex_count(); ++v) {
        const Point p = point_of(mesh, v);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min(box.low[axis], p[axis]);
            box.high[axis] = std::max(box.high[axis], p[axis]);
        }
    }
    return box;
}

/// Properties of one body, which is posed, or of a mesh.
struct Report {
    Report(const io::TriangleMesh& mesh, bool lists_open_edges)
        : vertices(mesh.vertex_count()),
          unused(count_unused_vertices(mesh)),
          triangles(mesh.triangle_count()),
          precision(mesh.precision() == ScalarType::float32 ? "float32" : "float64"),
          box(box_of(mesh)) {
        // Runs the two slowest reports in threads of their own.
        auto finds_duplicated = std::async(std::launch::async, [&] { return duplicated_triangles(mesh); });
        auto reports_edges = std::async(std::launch::async, [&] { return report_edges(mesh); });
        degenerate = degenerate_triangles(mesh);
        std::vector<std::int32_t> labels;
        components = label_components(mesh, labels);
        edges = reports_edges.get();
        duplicated = finds_duplicated.get();
        if (lists_open_edges) listed = open_edges(mesh.view());
        if (triangles > 0 && edges.closed && !edges.flipped) volume = signed_volume(mesh);
    }
    /// True if the body is closed and consistently oriented, and has no degenerate triangle. The test of --check: does
    /// not test whether the surface intersects itself.
    bool is_sound() const { return triangles > 0 && edges.closed && !edges.flipped && degenerate.empty(); }

    std::int64_t vertices, unused, triangles;
    const char* precision;
    std::optional<BoundingBox> box;
    std::vector<std::int32_t> degenerate, duplicated;
    EdgeReport edges;
    std::optional<Array<OpenEdge>> listed;
    std::int32_t components = 0;
    std::optional<double> volume;  ///< set for a closed mesh with consistent orientation
};

constexpr std::size_t most_edges = 3;  // number of open edges that are shown without --open-edges

/// Returns "3-5, from (0 0 0) to (1 0 0)": the vertices of an edge, by their indices in the mesh, and their positions.
std::string describe(const io::TriangleMesh& mesh, const Edge& edge) {
    return fmt::format("{}-{}, from ({}) to ({})", edge.a, edge.b, text_of_point(mesh, point_of(mesh, edge.a)),
                       text_of_point(mesh, point_of(mesh, edge.b)));
}

class Printer {
   public:
    Printer(std::ostream& out, io::Unit unit) : out_(out), unit_(unit) {}

    void row(std::string_view name, const std::string& value) { out_ << fmt::format("{:<22}{}\n", name, value); }

    void print_unit() { row("unit", io::name_of(unit_)); }

    void print(const io::TriangleMesh& mesh, const Report& report) {
        row("vertices", fmt::format("{} ({} unused)", grouped(report.vertices), grouped(report.unused)));
        row("triangles", grouped(report.triangles));
        row("precision", report.precision);
        if (report.box)
            row("box",
                fmt::format("{} to {}", text_of_point(mesh, report.box->low), text_of_point(mesh, report.box->high)));
        row("degenerate triangles", some(report.degenerate));
        row("duplicated triangles", some(report.duplicated));
        row("open edges", grouped(std::ssize(report.edges.open)));
        for (std::size_t i = 0; i < std::min(most_edges, report.edges.open.size()); ++i)
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

    std::string volume_of(const Report& report) const {
        if (!report.volume) return "none: the surface is not closed, or not consistently oriented";
        return fmt::format("{:.6g}{}{}", *report.volume,
                           unit_ == io::Unit::unknown ? "" : fmt::format(" {}^3", io::name_of(unit_)),
                           *report.volume < 0 ? ": the surface is inside out" : "");
    }

    std::ostream& out_;
    io::Unit unit_;
};

nlohmann::json json_of(const io::TriangleMesh& mesh, const Edge& edge) {
    return {{"vertices", {edge.a, edge.b}}, {"points", {point_of(mesh, edge.a), point_of(mesh, edge.b)}}};
}

nlohmann::json json_of(const std::string& name, const io::TriangleMesh& mesh, const Report& report) {
    using Json = nlohmann::json;
    Json open = Json::array();
    for (std::size_t i = 0; i < std::min(most_edges, report.edges.open.size()); ++i)
        open.push_back(json_of(mesh, report.edges.open[i]));
    Json listed = Json::array();
    for (const OpenEdge& edge : report.listed ? report.listed->span() : std::span<const OpenEdge>()) {
        listed.push_back(json_of(mesh, edge.edge));
        listed.back()["triangle"] = edge.triangle;
    }
    Json flipped;
    if (const auto& found = report.edges.flipped) {
        flipped = json_of(mesh, found->edge);
        flipped["triangles"] = {found->first, found->second};
    }
    Json result{{"name", name},
                {"vertices", report.vertices},
                {"unused_vertices", report.unused},
                {"triangles", report.triangles},
                {"precision", report.precision},
                {"box", report.box ? Json{{"low", report.box->low}, {"high", report.box->high}} : Json()},
                {"degenerate_triangles", report.degenerate},
                {"duplicated_triangles", report.duplicated},
                {"open_edges", {{"count", report.edges.open.size()}, {"first", open}}},
                {"holes", report.edges.holes},
                {"non_manifold_edges", report.edges.non_manifold},
                {"consistently_oriented", !report.edges.flipped},
                {"first_flipped_edge", flipped},
                {"connected_components", report.components},
                {"closed", report.triangles > 0 && report.edges.closed},
                {"volume", report.volume ? Json(*report.volume) : Json()},
                {"sound", report.is_sound()}};
    if (report.listed) result["list_of_open_edges"] = std::move(listed);
    return result;
}

struct Info {
    std::string file;
    ReadingOptions reading;
    bool json = false, check = false, open_edges = false;

    int run() const {
        const io::WorldMesh world = read_bodies({file}, reading);
        const auto bodies = world.bodies.size();
        const auto body = [&](std::size_t b) -> const io::NamedBody& { return world.bodies[b]; };
        const auto mesh = [&](std::size_t b) {
            io::WorldMesh alone;
            alone.shapes = {world.shapes[static_cast<std::size_t>(body(b).shape)]};
            alone.bodies = {body(b)};
            alone.bodies[0].shape = 0;
            alone.unit = world.unit;
            return body(b).pose == Pose{} ? std::move(alone.shapes[0]) : io::posed_mesh(alone);
        };
        bool sound = bodies > 0;
        nlohmann::json list = nlohmann::json::array();
        to_standard_output([&](std::ostream& out) {
            Printer printer(out, world.unit);
            const bool scene = is_scene() || bodies != 1;
            if (!json && scene) print_bodies(printer, world);
            if (!json && !scene) printer.print_unit();
            for (std::size_t b = 0; b < bodies; ++b) {
                const io::TriangleMesh posed = mesh(b);
                const Report report(posed, open_edges);
                sound = sound && report.is_sound();
                if (json) {
                    list.push_back(json_of(body(b).name, posed, report));
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
                     "Exit with status 1 unless every body is closed, consistently oriented, and without degenerate "
                     "triangles. To check whether a body passes through itself, use detect --check");
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
