// crumple info: what a file holds.

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/bodies.h"
#include "cli/commands.h"
#include "cli/search.h"
#include "cli/terminal.h"
#include "cli/topology.h"
#include "crumple/device.h"

namespace crumple::cli {
namespace {

/// "3 (5, 17, 40)": how many, and the first few.
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

void print_box(std::ostream& out, const io::TriangleMesh& mesh) {
    std::visit(
        [&](const auto& xyz) {
            auto low = std::array{xyz[0], xyz[1], xyz[2]}, high = low;
            for (std::size_t i = 0; i < xyz.size(); ++i) {
                low[i % 3] = std::min(low[i % 3], xyz[i]);
                high[i % 3] = std::max(high[i % 3], xyz[i]);
            }
            out << fmt::format("box                   {} to {}\n", fmt::join(low, " "), fmt::join(high, " "));
        },
        mesh.vertices);
}

void print_information(std::ostream& out, const io::TriangleMesh& mesh) {
    const auto row = [&](std::string_view name, const std::string& value) {
        out << fmt::format("{:<22}{}\n", name, value);
    };
    row("vertices", fmt::format("{} ({} unused)", grouped(mesh.vertex_count()), grouped(count_unused_vertices(mesh))));
    row("triangles", grouped(mesh.triangle_count()));
    row("precision", mesh.precision() == ScalarType::float32 ? "float32" : "float64");
    if (mesh.vertex_count() > 0) print_box(out, mesh);
    row("degenerate triangles", some(degenerate_triangles(mesh)));
    row("duplicated triangles", some(duplicated_triangles(mesh)));
    const EdgeCounts edges = count_edges(mesh);
    row("open edges", grouped(edges.open));
    row("non-manifold edges", grouped(edges.non_manifold));
    std::vector<std::int32_t> labels;
    row("connected components", grouped(label_components(mesh, labels)));
}

/// The bodies in their order, which is that of --poses.
void print_information(std::ostream& out, const io::WorldMesh& world) {
    const auto count = [](std::size_t n) { return grouped(static_cast<std::int64_t>(n)); };
    out << fmt::format("{:<22}{}\n{:<22}{}\n{:<22}{}\n", "bodies", count(world.bodies.size()), "shapes",
                       count(world.shapes.size()), "triangles", grouped(world.triangle_count()));
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        const io::NamedBody& body = world.bodies[b];
        const std::int64_t triangles = world.shapes[static_cast<std::size_t>(body.shape)].triangle_count();
        out << fmt::format("body {:<17}{}: shape {}, {} triangles\n", b, quoted_name(body.name), body.shape,
                           grouped(triangles));
    }
}

bool is_scene(const std::string& file) {
    const std::string extension = extension_of(file);
    return !is_standard(file) && (extension == ".glb" || extension == ".gltf" || extension == ".3mf");
}

/// A line for each device, or the reason why there is none.
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
    struct Info {
        std::string file;
        ReadingOptions reading;
    };
    const auto info = std::make_shared<Info>();
    CLI::App& command = *app.add_subcommand("info", "Tell what a mesh file holds, and what is odd about it");
    command
        .add_option("FILE", info->file,
                    "A mesh (PLY, OBJ, STL, OFF), a scene (.glb, .gltf, .3mf), or - for standard input")
        ->type_name("FILE")
        ->required();
    add_reading_options(command, info->reading);
    // Like --version, which CLI11 has this for: no file is needed, the text is printed, and that is all.
    command.set_version_flag("--devices", describe_devices,
                             "List the devices of the cuda backend, or why there is none, and exit");
    command.footer(
        "Degenerate and duplicated triangles are found by exact tests on positions; edges and components go by vertex\n"
        "index, so files without shared vertices want --weld.\n"
        "Example: crumple info part.stl");
    return {&command, [info] {
                if (is_scene(info->file)) {
                    const io::WorldMesh world = read_bodies({info->file}, info->reading);
                    to_standard_output([&](std::ostream& out) { print_information(out, world); });
                } else {
                    const io::TriangleMesh mesh = read_mesh(info->file, info->reading);
                    to_standard_output([&](std::ostream& out) { print_information(out, mesh); });
                }
                return static_cast<int>(done);
            }};
}

}  // namespace crumple::cli
