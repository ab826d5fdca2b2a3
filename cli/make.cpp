// crumple make: a procedural scene as a mesh file.

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "scenes/scenes.h"

namespace crumple::cli {
namespace {

struct Make {
    std::string scene, output;
    scenes::Parameters parameters;
    std::optional<int> frame;
    bool list = false;

    int run() {
        const auto known = scenes::descriptions();
        if (list) {
            if (!scene.empty() || !output.empty()) fail("--list makes no scene");
            to_standard_output([&](std::ostream& out) {
                out << fmt::format("{:<14}{:>10}{:>8}  {}\n", "scene", "triangles", "frames", "what it is");
                for (const scenes::Description& s : known) {
                    out << fmt::format("{:<14}{:>10}{:>8}  {}\n", s.name, s.triangles, s.frames, s.summary);
                }
            });
            return done;
        }
        if (scene.empty()) fail("make needs a SCENE; --list names them");
        if (output.empty()) fail("make needs a file to write: -o FILE");
        const auto found = std::find_if(known.begin(), known.end(), [&](const auto& s) { return s.name == scene; });
        const int last = found == known.end() ? 0 : found->frames - 1;
        parameters.frame = frame.value_or(last);
        io::write_mesh(output, scenes::make(scene, parameters));
        return done;
    }

    static void fail(const char* message) { throw Error(ErrorCode::invalid_argument, message, Element::option); }
};

}  // namespace

Command add_make(CLI::App& app) {
    const auto make = std::make_shared<Make>();
    CLI::App& command = *app.add_subcommand("make", "Make a procedural scene");
    command.add_option("SCENE", make->scene, "Its name; see --list")->type_name("SCENE");
    command.add_flag("--list", make->list, "List the scenes and do nothing else");
    command.add_option("--triangles", make->parameters.triangles, "About how many; without it the scene's own number")
        ->type_name("N")
        ->check(CLI::Range(1, 500'000'000).description(""));
    command.add_option("--frame", make->frame, "Which frame, from 0; without it the last")->type_name("I");
    command.add_option("--seed", make->parameters.seed, "Other numbers give other scenes of the same kind")
        ->type_name("N");
    command.add_option("-o,--output", make->output, "Mesh file: .ply, .obj, .stl or .off")->type_name("FILE");
    command.footer("Example: crumple make cloth --triangles 2000000 -o cloth.ply");
    return {&command, [make] { return make->run(); }};
}

}  // namespace crumple::cli
