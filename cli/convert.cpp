// crumple convert: a mesh, or the bodies of a scene where they are, as a file of another format.

#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "cli/commands.h"
#include "cli/options.h"
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

    /// The bodies of a scene are posed; what is one mesh keeps its polygons.
    static io::TriangleMesh one_mesh(io::WorldMesh world) {
        const bool in_place = world.bodies.size() == 1 && world.bodies[0].pose == Pose{};
        if (!in_place) {
            io::TriangleMesh mesh = io::posed_mesh(world);
            mesh.groups.clear();  // numbers of the bodies
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
                        "cannot write " + what + ": meshes are written as .ply, .obj, .stl, .off or .3mf");
        }
        check_not_input();
        mesh_format == io::MeshFormat::threemf ? write_bodies(read()) : write(one_mesh(read()), mesh_format);
        return done;
    }

    void write(const io::TriangleMesh& mesh, io::MeshFormat mesh_format) const {
        const io::WriteOptions how{.polygons = true};
        if (is_standard(output))
            to_standard_output([&](std::ostream& out) { io::write_mesh(out, mesh, mesh_format, how); });
        else
            io::write_mesh(output, mesh, how);
    }

    void write_bodies(const io::WorldMesh& world) const {
        if (is_standard(output))
            to_standard_output([&](std::ostream& out) { io::write_world(out, world); });
        else
            io::write_world(output, world);
    }

    void check_not_input() const {
        std::error_code missing;  // then they are not the same file
        if (is_standard(input) || is_standard(output) || !std::filesystem::equivalent(input, output, missing)) return;
        throw Error(ErrorCode::invalid_argument, output + " is the file that is read", Element::option);
    }
};

}  // namespace

Command add_convert(CLI::App& app) {
    const auto convert = std::make_shared<Convert>();
    CLI::App& command = *app.add_subcommand("convert", "Write a mesh in another format");
    command
        .add_option(
            "IN", convert->input,
            "A mesh (PLY, OBJ, STL, OFF), or a scene (glTF, 3MF), whose bodies are put where they are and become "
            "one mesh; in .3mf they stay bodies. - is standard input")
        ->type_name("IN")
        ->required();
    command
        .add_option("OUT", convert->output,
                    "Mesh file: .ply, .obj, .stl, .off or .3mf; - is standard output, see --format")
        ->type_name("OUT")
        ->required();
    add_format_option(command, convert->format, "ply|obj|stl|off|3mf");
    add_reading_options(command, convert->reading);
    command.footer(
        "Coordinates keep their precision, except in .stl, which holds float32. Polygons stay polygons, except\n"
        "in .stl and .3mf. Colours, normals, texture coordinates, lines and points of OBJ and, but for .3mf,\n"
        "names are left out. Files named .gz are compressed, here and in all commands.\n\n"
        "Example: crumple convert --weld scan.stl scan.ply");
    return {&command, [convert] { return convert->run(); }};
}

}  // namespace crumple::cli
