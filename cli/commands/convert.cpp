// crumple convert: writes a mesh, or the posed bodies of a scene, in another format.

#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/search.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

struct Convert {
    std::string input, output, format;
    ReadingOptions reading;

    io::WorldMesh read() const {
        const io::ReadOptions how = read_options(reading);
        io::WorldMesh world =
            is_standard(input) ? io::read_world(std::cin, "standard input", how) : io::read_world(input, how);
        for (const std::string& warning : world.warnings) print_warning(warning);
        return world;
    }

    /// Joins the posed bodies of a scene into one mesh. A single body with the identity pose is returned unchanged,
    /// with its polygons.
    static io::TriangleMesh one_mesh(io::WorldMesh world) {
        const bool in_place = world.bodies.size() == 1 && world.bodies[0].pose == Pose{};
        if (!in_place) {
            io::TriangleMesh mesh = io::posed_mesh(world);
            mesh.groups.clear();  // posed_mesh() sets them to the indices of bodies
            return mesh;
        }
        return std::move(world.shapes.at(static_cast<std::size_t>(world.bodies[0].shape)));
    }

    int run() const {
        check_format({output}, format);
        const io::MeshFormat mesh_format = io::mesh_format_of(extension_of(output, format));
        if (!io::holds_meshes(mesh_format)) {
            const std::string what = is_standard(output) ? "-o - --format " + format : output;
            throw Error(ErrorCode::invalid_argument,
                        "cannot write " + what + ": meshes are written as .ply, .obj, .stl, .off, .glb or .3mf");
        }
        check_not_input();
        const bool keeps_bodies = mesh_format == io::MeshFormat::threemf || mesh_format == io::MeshFormat::glb;
        keeps_bodies ? write_bodies(read(), mesh_format) : write(one_mesh(read()), mesh_format);
        return done;
    }

    void print_summary(std::int64_t triangles, std::size_t bodies, io::Unit unit) const {
        std::string text = grouped(triangles) + (triangles == 1 ? " triangle" : " triangles");
        if (bodies > 1) text += fmt::format(" in {} bodies", grouped(static_cast<std::int64_t>(bodies)));
        text += " to " + (is_standard(output) ? "standard output" : output);
        if (unit != io::Unit::unknown) text += fmt::format(", unit {}", io::name_of(unit));
        say("{}\n", text);
    }

    void write(const io::TriangleMesh& mesh, io::MeshFormat mesh_format) const {
        const io::WriteOptions how{.polygons = true};
        if (is_standard(output))
            to_standard_output([&](std::ostream& out) { io::write_mesh(out, mesh, mesh_format, how); });
        else
            io::write_mesh(output, mesh, how);
        print_summary(mesh.triangle_count(), 1, mesh.unit);
    }

    void write_bodies(const io::WorldMesh& world, io::MeshFormat format_of_bodies) const {
        if (is_standard(output))
            to_standard_output([&](std::ostream& out) { io::write_world(out, world, format_of_bodies); });
        else
            io::write_world(output, world);
        // glTF files are in metres: write_world() scales bodies with a known unit.
        const bool in_metres = format_of_bodies == io::MeshFormat::glb && world.unit != io::Unit::unknown;
        print_summary(world.triangle_count(), world.bodies.size(), in_metres ? io::Unit::metre : world.unit);
    }

    void check_not_input() const {
        std::error_code missing;  // set if one of the files does not exist; they differ then
        if (is_standard(input) || is_standard(output) || !std::filesystem::equivalent(input, output, missing)) return;
        throw Error(ErrorCode::invalid_argument, output + " is the input; choose another name", Element::option);
    }
};

}  // namespace

Command add_convert(CLI::App& app) {
    const auto convert = std::make_shared<Convert>();
    CLI::App& command = *app.add_subcommand("convert", "Write a mesh in another format");
    command
        .add_option("IN", convert->input,
                    "A mesh (PLY, OBJ, STL, OFF), or a scene (glTF, 3MF), whose posed bodies become one mesh, except "
                    "in .3mf and .glb, where they stay bodies. - is standard input")
        ->type_name("IN")
        ->required();
    command
        .add_option("OUT", convert->output,
                    "Mesh file: .ply, .obj, .stl, .off, .glb or .3mf; - is standard output, see --format")
        ->type_name("OUT")
        ->required();
    add_format_option(command, convert->format, "ply|obj|stl|off|glb|3mf");
    add_reading_options(command, convert->reading);
    command.footer(
        "Coordinates keep their precision, except in .stl and .glb, which hold float32. Polygons stay polygons,\n"
        "except in .stl, .glb and .3mf. .3mf and .glb keep names and the unit; a .glb is in metres, to which its\n"
        "bodies are scaled. Colours, normals, texture coordinates, lines and points of OBJ are left out. In all\n"
        "commands, a file is compressed if its name ends with .gz.\n\n"
        "Example: crumple convert --weld scan.stl scan.ply");
    return {&command, [convert] { return convert->run(); }};
}

}  // namespace crumple::cli
