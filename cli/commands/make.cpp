// crumple make: writes a procedural or simulated scene as a mesh file, or as one file per frame.

#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/numbered.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "io/formats.h"
#include "scenes/scenes.h"

namespace crumple::cli {
namespace {

struct Make {
    std::string scene, output, format;
    scenes::Parameters parameters;
    std::optional<int> frame;
    int last_frame = 0;
    bool list = false, all_frames = false;

    int run() {
        if (list) {
            if (!scene.empty() || !output.empty()) fail("--list does not go with SCENE or -o");
            to_standard_output([&](std::ostream& out) {
                out << fmt::format("{:<14}{:>10}{:>8}  {}\n", "scene", "triangles", "frames", "what it is");
                for (const scenes::Description& s : scenes::descriptions()) {
                    out << fmt::format("{:<14}{:>10}{:>8}  {}\n", s.name, s.triangles, s.frames, s.summary);
                }
            });
            return done;
        }
        if (scene.empty()) fail("make needs a SCENE; --list shows all scenes");
        if (output.empty()) fail("make needs -o FILE, the file to write");
        check_format({output}, format);
        const io::MeshFormat mesh_format = io::mesh_format_of(extension_of(output, format));
        if (!io::holds_meshes(mesh_format)) {  // checked first, because a simulation may take minutes
            throw Error(ErrorCode::invalid_argument,
                        "cannot write " + output + ": meshes are written as .ply, .obj, .stl, .off, .glb or .3mf");
        }
        if (all_frames && frame) fail("--all-frames and --frame exclude each other");
        if (all_frames && is_standard(output)) fail("--all-frames needs files: -o FILE");
        std::optional<Progress> bar;
        scenes::Animation animation(scene, parameters, [&](int reached, int last) {
            if (!bar) bar.emplace(static_cast<std::size_t>(all_frames ? last_frame : last));
            bar->show(static_cast<std::size_t>(reached), scene);
        });
        const int frames = animation.description().frames;
        last_frame = frames - 1;
        if (!all_frames) {
            const io::TriangleMesh mesh = animation.frame(frame.value_or(last_frame));
            bar.reset();
            if (!is_standard(output)) {
                io::write_mesh(output, mesh);
            } else {
                to_standard_output([&](std::ostream& out) { io::write_mesh(out, mesh, mesh_format); });
            }
            say("{} triangles to {}\n", grouped(mesh.triangle_count()),
                is_standard(output) ? "standard output" : output);
            return done;
        }
        for (int i = 0; i < frames; ++i) {
            io::write_mesh(numbered(output, static_cast<std::size_t>(i), static_cast<std::size_t>(frames)),
                           animation.frame(i));
        }
        say("{} frames to {}\n", frames, output);
        return done;
    }

    [[noreturn]] static void fail(const char* message) {
        throw Error(ErrorCode::invalid_argument, message, Element::option);
    }
};

}  // namespace

Command add_make(CLI::App& app) {
    const auto make = std::make_shared<Make>();
    CLI::App& command = *app.add_subcommand("make", "Make a procedural or simulated scene");
    command.add_option("SCENE", make->scene, "Name of the scene; see --list")->type_name("SCENE");
    command.add_flag("--list", make->list, "List the scenes and do nothing else");
    command
        .add_option("--triangles", make->parameters.triangles,
                    "Approximate number of triangles; without it, the scene's default")
        ->type_name("N")
        ->check(integer(1, 500'000'000));
    command.add_option("--frame", make->frame, "Number of the frame to write, from 0; without it, the last one")
        ->type_name("I");
    command.add_flag("--all-frames", make->all_frames,
                     "Write every frame; FILE gets the frame's number before its extension");
    command
        .add_option("--seed", make->parameters.seed,
                    "Seed of the random numbers: other seeds give other scenes of the same kind")
        ->type_name("N")
        ->check(integer(0, std::numeric_limits<std::int64_t>::max()));
    command
        .add_option("-o,--output", make->output,
                    "Mesh file: .ply, .obj, .stl, .off, .glb or .3mf; - is standard output, see --format")
        ->type_name("FILE");
    add_format_option(command, make->format, "ply|obj|stl|off|glb|3mf");
    command.footer(
        "A simulated scene takes seconds to minutes; its frames are cached under $XDG_CACHE_HOME/crumple or\n"
        "~/.cache/crumple for the next time.\n\n"
        "Example: crumple make cloth_on_ball --frame 60 -o cloth.ply");
    return {&command, [make] { return make->run(); }};
}

}  // namespace crumple::cli
