// crumple detect: the pairs of one mesh against itself, or of two meshes against each other.

#include <algorithm>
#include <memory>

#include "cli/commands.h"
#include "cli/search.h"
#include "cli/statistics_table.h"
#include "cli/terminal.h"
#include "crumple/error.h"

namespace crumple::cli {
namespace {

struct Detect {
    std::vector<std::string> files, outputs;
    AnswerOptions answer;
    Options options;
    bool check = false, stats = false;

    static bool is_list(const std::string& path) {
        const std::string e = extension_of(path);
        return e == ".txt" || e == ".csv" || e == ".json" || e == ".npz";
    }
    static bool is_picture(const std::string& path) {
        const std::string e = extension_of(path);
        return e == ".ply" || e == ".obj" || e == ".glb";
    }

    void check_output_formats() const {
        for (const std::string& path : outputs) {
            if (!is_list(path) && !is_picture(path)) {
                throw Error(ErrorCode::invalid_argument,
                            "-o " + (path.empty() ? "''" : path) +
                                ": pairs are written as .txt, .csv, .json or .npz, coloured meshes as .ply, .obj or "
                                ".glb");
            }
        }
        if (answer.contacts && !outputs.empty() && std::none_of(outputs.begin(), outputs.end(), is_list)) {
            throw Error(ErrorCode::invalid_argument,
                        "--contacts: coloured meshes hold no contacts; write a .txt, .csv, .json or .npz");
        }
    }

    int run() const {
        check_output_formats();
        check_outputs(outputs, files, answer);
        Search search(answer, options);
        const Input input = read_input(files, answer);
        const Collisions& found = search.find(input);
        if (stats) print_statistics(found.statistics, count_hits(found));
        for (const std::string& path : outputs) {
            if (is_list(path)) {
                io::write_pairs(path, found);
            } else {
                io::write_coloured(path, input.first, input.second_or_null(), found);
            }
        }
        if (outputs.empty()) to_standard_output([&](std::ostream& out) { io::write_pairs(out, found); });
        return check && !found.pairs.empty() ? collided : done;
    }
};

}  // namespace

Command add_detect(CLI::App& app) {
    const auto detect = std::make_shared<Detect>();
    CLI::App& command = *app.add_subcommand("detect", "Find every pair of colliding triangles");
    command.add_option("FILE", detect->files, "A mesh (PLY, OBJ, STL, OFF) against itself, or two against each other")
        ->type_name("FILE [FILE_B]")
        ->required()
        ->expected(1, 2);
    command
        .add_option("-o,--output", detect->outputs,
                    "Pairs as .txt, .csv, .json or .npz, or the mesh with colliding triangles coloured as .ply, .obj "
                    "or .glb; may be repeated. Without it pairs go to standard output, `i j` a line")
        ->type_name("OUT")
        ->allow_extra_args(false);
    add_answer_options(command, detect->answer);
    command.add_flag("--contacts", detect->answer.contacts, "Also where each pair meets: its kind and its points");
    command.add_flag("--check", detect->check, "Exit with status 1 if anything collides");
    command.add_flag("--stats", detect->stats, "Print times and counts of the stages to standard error");
    add_cost_options(command, detect->options);
    command.footer("Example: crumple detect dress.ply body.obj -o dress.glb -o pairs.csv --contacts");
    return {&command, [detect] { return detect->run(); }};
}

}  // namespace crumple::cli
